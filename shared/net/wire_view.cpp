#include <macula/v1/view.pb.h>

#include <algorithm>

#include "shared/base/text.h"
#include "shared/net/wire_parts.h"

namespace macula::net::wire {

void write(const Acks& acks, v1::Acks& out) {
  out.set_epoch(acks.epoch);
  out.set_received(acks.received);
  out.set_receiving(acks.receiving);
  out.set_receiving_bytes(acks.receiving_bytes);
  out.set_need_key(acks.need_key);
  out.set_least_rtt_ns(acks.least_rtt.count());
}

Acks read(const v1::Acks& in) {
  // A round trip beyond ten seconds is a mistake or a lie; it then says nothing.
  constexpr std::int64_t kMost_ns = 10'000'000'000;
  const std::int64_t rtt_ns = in.least_rtt_ns();
  return {in.epoch(),     in.received(),
          in.receiving(), in.receiving_bytes(),
          in.need_key(),  Nanoseconds{rtt_ns <= kMost_ns ? std::max<std::int64_t>(rtt_ns, 0) : 0}};
}

void write(const ViewState& view, v1::ViewState& out) {
  out.set_sequence(view.sequence);
  out.set_sampled_client_ns(ns_of(view.sampled));
  out.set_predicted_display_client_ns(ns_of(view.predicted_display));
  write(view.stage_from_head, *out.mutable_stage_from_head());
  for (const EyeState& eye : view.eyes) {
    v1::EyeState& written = *out.add_eyes();
    write(eye.head_from_eye, *written.mutable_head_from_eye());
    write(eye.fov, *written.mutable_fov());
    write(eye.gaze, *written.mutable_gaze());
  }
  out.set_gaze_sampled_client_ns(ns_of(view.gaze_sampled));
  write(view.acks, *out.mutable_acks());
}

Result<ViewState> read(const v1::ViewState& in) {
  ViewState view;
  view.sequence = in.sequence();
  view.sampled = client_time(in.sampled_client_ns());
  view.predicted_display = client_time(in.predicted_display_client_ns());
  view.stage_from_head = read(in.stage_from_head());
  for (const v1::EyeState& eye : in.eyes()) {
    view.eyes.push_back({read(eye.head_from_eye()), read(eye.fov()), read(eye.gaze())});
  }
  view.gaze_sampled = client_time(in.gaze_sampled_client_ns());
  view.acks = read(in.acks());
  return view;
}

}  // namespace macula::net::wire
