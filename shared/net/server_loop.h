// The server's net thread: the only owner of the ROUTER socket, its monitor and the ZAP handler.
// Sleeps in poll, stamps what it receives at once, answers Pings before anything else, beats every
// 100 ms, and feeds each peer's frames to the socket as it takes them. Other threads reach it
// through post().
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

#include "shared/net/frame_sender.h"
#include "shared/net/keys.h"
#include "shared/net/open_connections.h"
#include "shared/net/server_events.h"
#include "shared/net/zap.h"
#include "shared/net/zmq_socket.h"

namespace macula::net {

struct SendMessage {
  PeerId peer;
  Message message;
};
struct SendFrame {
  PeerId peer;
  EncodedFrame frame;
  ServerTime handed_over;
};
struct Stop {};
using ServerCommand = std::variant<SendMessage, SendFrame, Stop>;

class ServerLoop {
 public:
  static Result<std::unique_ptr<ServerLoop>> create(const ServerEndpointOptions& options,
                                                    const base::Clock& clock);
  /// Until a Stop is posted.
  void run();

  // Thread-safe from here on.
  void post(ServerCommand command);
  ServerEvents& events() { return events_; }
  ServerCounters counters() const;
  const std::string& endpoint() const { return endpoint_; }
  const std::string& public_key_z85() const { return public_key_; }
  ServerTime now() const { return ServerTime{clock_.now()}; }

 private:
  struct Peer {
    Peer(PeerId id_, std::string routing_id_, std::string key_, FrameSender frames_)
        : id(id_),
          routing_id(std::move(routing_id_)),
          key_z85(std::move(key_)),
          frames(std::move(frames_)) {}
    PeerId id;
    std::string routing_id, key_z85;
    FrameSender frames;
    std::deque<Message> control;  ///< goes before frames; Pongs are stamped as they leave
    std::uint64_t last_view = 0;
    bool has_said_hello = false, is_gone = false;
    SteadyTime last_heard{};
  };

  ServerLoop(const ServerEndpointOptions& options, const base::Clock& clock);
  Result<void> open(const KeyPair& keys);
  void end_silent_connections();

  void round();
  void sleep();
  SteadyTime next_deadline() const;
  void read_monitor();
  void receive_all();
  void take_commands();
  void beat();
  void flush(Peer& peer);
  void forget_the_gone();
  void publish_counters();

  void on_message(const Incoming& message, ServerTime received);
  Peer& peer_of(std::string_view routing_id, const std::string& key_z85);
  bool is_admitted(const std::string& key_z85) const;
  void read_admitted();
  void expel_the_revoked();
  Peer* find(PeerId id);
  void refuse(Peer& peer, RefusalCode code, std::string text);
  void on_undecodable(Peer& peer, const Error& error);

  void on(Peer& peer, Hello&& hello, ServerTime received);
  void on(Peer& peer, ViewState&& view, ServerTime received);
  void on(Peer& peer, Acks&& acks, ServerTime received);
  void on(Peer& peer, Settings&& settings, ServerTime received);
  void on(Peer& peer, Bye&& bye, ServerTime received);
  void on(Peer& peer, Ping&& ping, ServerTime received);
  /// Messages that only servers send.
  template <class Other>
  void on(Peer& peer, Other&&, ServerTime) {
    on_foreign(peer);
  }
  void on_foreign(Peer& peer);
  bool take_acks(Peer& peer, const Acks& acks);

  void execute(SendMessage&& command);
  void execute(SendFrame&& command);
  void execute(Stop&&) { stopping_ = true; }

  const ServerEndpointOptions options_;
  const base::Clock& clock_;
  std::string endpoint_, public_key_;
  Wakeup wakeup_;
  DeadlineTimer timer_;
  Context context_;
  ZapHandler zap_;
  std::unique_ptr<Socket> router_;
  std::unique_ptr<Monitor> monitor_;
  OpenConnections connections_;

  std::unordered_map<std::string, Peer> peers_;  ///< by routing id
  std::vector<std::string> admitted_;            ///< keys allowed when last looked
  SteadyTime admitted_read_{};
  std::uint64_t handshakes_ = 0;  ///< successful ones, when last looked
  std::uint64_t last_peer_ = 0, beats_ = 0;
  SteadyTime beat_due_{};
  bool stopping_ = false;
  ServerCounters own_counters_;

  ServerEvents events_;
  mutable std::mutex mutex_;  ///< guards the two below
  std::vector<ServerCommand> commands_;
  ServerCounters published_counters_;
};

}  // namespace macula::net
