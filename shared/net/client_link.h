// The client's socket and its life: connecting, shaking hands, ready, failed, and made anew after a
// back-off of 100..800 ms (a server that is back is found within a second). libzmq's DEALER stays
// deaf after one damaged byte or a refused key, so every failure the monitor reports ends the
// socket. Lives on the net thread.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "shared/net/handshake_text.h"
#include "shared/net/keys.h"
#include "shared/net/zmq_socket.h"

namespace macula::net {

class ClientLink {
 public:
  struct Options {
    LinkNames names;
    KeyPair keys;
    std::string server_key_z85;
    Limits limits;
  };

  explicit ClientLink(Options options) : options_(std::move(options)) {}

  /// Whether libzmq takes the endpoint at all.
  Result<void> open(SteadyTime now);
  /// Reads the monitor and reopens when the back-off is over. A failure is returned once.
  std::optional<LinkFailure> attend(SteadyTime now);
  /// Ends the socket for a reason the monitor cannot see; it is made anew at once.
  void remake(SteadyTime now);
  /// The back-off starts from its least again.
  void trust() { back_off_ = kLeastBackOff; }
  /// Stays closed until then (a server asked for it).
  void rest_until(SteadyTime then, SteadyTime now);

  bool is_ready() const { return phase_ == LinkPhase::Ready && socket_ != nullptr; }
  /// Grows with every handshake that succeeds: a new connection is a new peer to the server.
  std::uint64_t connections() const { return connections_; }
  std::uint64_t remakes() const { return remakes_; }
  /// When attend() has something to do that no descriptor announces.
  std::optional<SteadyTime> deadline() const { return reopen_at_; }

  SendOutcome send(const Outgoing& message);
  bool receive(Incoming& message) { return socket_ && socket_->receive(message); }
  bool has_input() const;
  /// nullptr while closed.
  const Socket* socket() const { return socket_.get(); }
  const Monitor* monitor() const { return monitor_.get(); }
  /// What was sent may still leave for this long after the destructor.
  void linger(std::chrono::milliseconds time);

 private:
  static constexpr std::chrono::milliseconds kLeastBackOff{100}, kMostBackOff{800};

  void close();
  void fail(SteadyTime now);

  const Options options_;
  Context context_;
  std::unique_ptr<Socket> socket_;
  std::unique_ptr<Monitor> monitor_;
  LinkPhase phase_ = LinkPhase::Connecting;
  std::optional<SteadyTime> reopen_at_;
  std::chrono::milliseconds back_off_ = kLeastBackOff;
  std::uint64_t connections_ = 0, remakes_ = 0;
};

}  // namespace macula::net
