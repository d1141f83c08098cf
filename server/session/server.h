// The server at work: three threads drive the session table. Control waits for the network's
// events, render takes the newest view of the next session and runs the kernel, encode packs the
// frame before. Rendering frame n + 1 overlaps encoding frame n where there are more cores than the
// encoder takes; else n is encoded first, and n + 1 starts from a newer view. Frames leave when
// their session has credit. The table sits behind one mutex that is never held while rendering,
// encoding or waiting.
#pragma once

#include <atomic>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "server/session/config.h"
#include "server/session/encode_stage.h"
#include "server/session/frame_job.h"
#include "server/session/frame_log.h"
#include "server/session/recording.h"
#include "server/session/render_stage.h"
#include "server/session/session_table.h"
#include "server/session/telemetry.h"
#include "shared/base/mailbox.h"

namespace macula::session {

/// What a server is made of; the clock must outlive it and be the endpoint's.
struct ServerParts {
  std::unique_ptr<net::ServerEndpoint> endpoint;
  std::shared_ptr<kernels::SceneTimeline> scene;
  std::shared_ptr<const kernels::Kernel> kernel;
  std::shared_ptr<scheduling::TileScheduler> scheduler;
  const base::Clock* clock = nullptr;
  std::unique_ptr<Recorder> recorder{};  ///< null: nothing is recorded
  std::unique_ptr<FrameLog> log{};       ///< null: frames are not listed
  SessionTable::RandomBits random;
};

class Server {
 public:
  /// Errors: a setting out of range.
  static Result<std::unique_ptr<Server>> create(ServerConfig config, ServerParts parts);
  ~Server() { stop(); }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  void start();
  /// Says Bye, and why, to every client, stops the frame being rendered and joins the threads.
  /// Idempotent.
  void stop(const std::string& reason = "the server is stopping");
  Telemetry telemetry() const;
  std::string endpoint() const { return parts_.endpoint->endpoint(); }
  std::string public_key_z85() const { return parts_.endpoint->public_key_z85(); }

 private:
  using Job = std::unique_ptr<FrameJob>;
  struct Rendering {
    FrameKey key;
    std::stop_source stop;
  };
  struct NextFrame {
    StartFrame start;
    std::shared_ptr<RenderMemory> memory;
    std::stop_token stop;
  };

  Server(ServerConfig config, ServerParts parts);
  ServerTime now() const { return ServerTime{parts_.clock->now()}; }

  void control_loop();
  void render_loop();
  void encode_loop();
  /// Waits until a frame may start; nullopt when the server stops.
  std::optional<NextFrame> wait_for_frame();
  void render(Job job, NextFrame next);
  void give_back(Job job);
  void finish_encoding(const FrameJob& job, Result<net::EncodedFrame> encoded);
  void give_up(const FrameKey& key, const std::string& why);

  // All of these need mutex_.
  void take(const net::ServerEvent& event);
  std::shared_ptr<RenderMemory> memory_of(const FrameKey& key);
  void carry_out(Actions actions);
  void act(SendWelcome&& action);
  void act(SendRefusal&& action);
  void act(SendBye&& action);
  void act(ReleaseFrame&& action);
  void act(AbandonFrames&& action);
  void act(DropSession&& action);

  const ServerConfig config_;
  ServerParts parts_;
  RenderStage render_stage_;
  EncodeStage encode_stage_;
  const bool overlaps_;  ///< a frame may render while the one before it is encoded
  std::atomic<bool> memory_freed_ = false;  ///< a session's, since the control loop last looked
  base::Channel<Job> free_jobs_, rendered_;

  mutable std::mutex mutex_;
  std::condition_variable may_start_;
  bool stopping_ = false;
  SessionTable table_;
  std::map<FrameKey, net::EncodedFrame> outbox_;  ///< encoded, waiting for credit
  std::map<std::uint64_t, std::shared_ptr<RenderMemory>> memories_;  ///< by session
  std::optional<Rendering> rendering_;
  bool encoding_ = false;  ///< with overlap, of one frame at least
  Telemetry telemetry_;

  std::thread control_, render_, encode_;
};

}  // namespace macula::session
