#include <macula/v1/telemetry.pb.h>

#include "shared/net/wire_parts.h"

namespace macula::net::wire {

void write(const Ping& ping, v1::Ping& out) {
  out.set_sequence(ping.sequence);
  out.set_sent_client_ns(ns_of(ping.sent));
}

/// Only echoed, never reckoned with, so any time is legal.
Ping read(const v1::Ping& in) {
  return {in.sequence(), client_time(in.sent_client_ns())};
}

void write(const Pong& pong, v1::Pong& out) {
  out.set_sequence(pong.sequence);
  out.set_sent_client_ns(ns_of(pong.ping_sent));
  out.set_received_server_ns(ns_of(pong.ping_received));
  out.set_sent_server_ns(ns_of(pong.pong_sent));
}

Result<Pong> read(const v1::Pong& in) {
  const Pong pong{in.sequence(), client_time(in.sent_client_ns()),
                  server_time(in.received_server_ns()), server_time(in.sent_server_ns())};
  if (!is_plausible(pong.ping_sent) || !is_plausible(pong.ping_received) ||
      !is_plausible(pong.pong_sent)) {
    return base::bad_input("time beyond 73 years", "pong");
  }
  return pong;
}

void write(const Beat& beat, v1::Beat& out) {
  out.set_sequence(beat.sequence);
  out.set_sent_server_ns(ns_of(beat.sent));
}

Result<Beat> read(const v1::Beat& in) {
  const Beat beat{in.sequence(), server_time(in.sent_server_ns())};
  if (!is_plausible(beat.sent)) return base::bad_input("time beyond 73 years", "beat");
  return beat;
}

}  // namespace macula::net::wire
