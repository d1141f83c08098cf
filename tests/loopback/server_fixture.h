// A whole server on loopback: real endpoint, real kernel, the Cornell box, keys in a folder of its
// own. And a client that is only its endpoint: it looks around, takes frames and remembers their
// headers.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "server/kernels/registry.h"
#include "server/kernels/scene_frame.h"
#include "server/scene/load.h"
#include "server/session/server.h"
#include "shared/net/client_endpoint.h"
#include "shared/net/keys.h"
#include "tests/support/temporary_folder.h"

namespace macula::loopback {

using namespace std::chrono_literals;

using test::TemporaryFolder;

struct LoopbackServerOptions {
  std::string bind = "tcp://127.0.0.1:0";
  session::StageDelays delays;    ///< of the server's own stages
  net::ServerDelays wire_delays;  ///< of its endpoint
  std::string record;             ///< file; empty: nothing is recorded
  std::optional<Nanoseconds> age_goal;
  Nanoseconds longest_horizon{0};  ///< as SessionRules has them
  double most_view_cell_m = 0.0;
  std::string scene = "cornell";
};

/// Serves from construction to destruction.
class LoopbackServer {
 public:
  explicit LoopbackServer(const std::string& key_folder,
                          const LoopbackServerOptions& options = {}) {
    net::ServerEndpointOptions wire;
    wire.bind = options.bind;
    wire.key_folder = key_folder;
    wire.delays = options.wire_delays;
    auto endpoint = net::ServerEndpoint::create(wire, clock_);
    if (!endpoint) {
      ADD_FAILURE() << endpoint.error().message();
      return;
    }
    session::ServerConfig config = make_config();
    config.delays = options.delays;
    config.age_goal = options.age_goal;
    config.rules.longest_horizon = options.longest_horizon;
    config.rules.most_view_cell_m = options.most_view_cell_m;
    session::ServerParts parts;
    parts.endpoint = std::move(*endpoint);
    parts.scene = shared_scene(options.scene);
    parts.kernel = make_kernel();
    parts.scheduler = std::make_shared<scheduling::TileScheduler>(1);
    parts.clock = &clock_;
    parts.random = [device = std::make_shared<std::random_device>()] {
      return static_cast<std::uint64_t>((*device)()) << 32 | (*device)();
    };
    if (!options.record.empty()) {
      parts.recorder = std::move(*session::Recorder::create(options.record, "loopback test"));
    }
    server_ = std::move(*session::Server::create(config, std::move(parts)));
    server_->start();
  }

  static session::ServerConfig make_config() { return {}; }
  static std::unique_ptr<kernels::Kernel> make_kernel() {
    return std::move(*kernels::make_kernel("ray", cheap()));
  }
  static std::shared_ptr<kernels::SceneTimeline> shared_scene(const std::string& name = "cornell") {
    static std::map<std::string, std::shared_ptr<kernels::SceneTimeline>> timelines;
    auto& timeline = timelines[name];
    if (!timeline) timeline = *kernels::SceneTimeline::create(*scene::load_scene(name));
    return timeline;
  }

  session::Server& operator*() { return *server_; }
  session::Server* operator->() { return server_.get(); }

 private:
  static kernels::KernelOptions cheap() {
    kernels::KernelOptions options;
    options.area_light_samples = 1;
    options.ambient_samples = 0;
    return options;
  }

  base::SteadyClock clock_;
  std::unique_ptr<session::Server> server_;
};

/// One viewer with two small eyes of `side_px`. Single-threaded: step() is one refresh.
class EndpointClient {
 public:
  EndpointClient(const std::string& connect, const std::string& key_folder,
                 const std::string& server_key, int side_px = 64,
                 const std::string& color_codec = {})
      : display_{math::symmetric_fov(Degrees{90.0}, 1.0), side_px, side_px} {
    net::ClientEndpointOptions options;
    options.connect = connect;
    options.key_folder = key_folder;
    options.server_key_z85 = server_key;
    options.hello.program = "loopback test";
    options.hello.eyes.assign(2, display_);
    options.hello.codecs = {"jpeg", "lossless"};
    options.hello.abilities = {net::kHiddenLayerAbility};
    options.hello.settings.color_codec = color_codec;
    if (codec::can_decode_h264()) options.hello.codecs.push_back("h264");
    auto created = net::ClientEndpoint::create(options, clock_);
    if (!created) {
      ADD_FAILURE() << created.error().message();
      return;
    }
    endpoint_ = std::move(*created);
  }

  EndpointClient(const EndpointClient&) = delete;
  EndpointClient& operator=(const EndpointClient&) = delete;

  /// Sends a view and takes a frame when one comes within `wait`.
  void step(std::chrono::milliseconds wait = 4ms) {
    endpoint_->publish(next_view());
    take(wait);
  }
  void take(std::chrono::milliseconds wait) {
    if (auto frame = endpoint_->wait_frame(wait)) frames_.push_back(std::move(*frame));
    while (auto event = endpoint_->take_event()) {
      if (std::holds_alternative<net::Stale>(*event)) ++stales_;
      if (const auto* welcomed = std::get_if<net::Welcomed>(&*event))
        welcomes_.push_back(*welcomed);
    }
  }
  /// Steps until `done`; false after a patience that only ends a test that hangs.
  bool step_until(const std::function<bool()>& done, std::chrono::seconds patience = 60s) {
    const auto until = std::chrono::steady_clock::now() + patience;
    while (!done()) {
      if (std::chrono::steady_clock::now() > until) return false;
      step();
    }
    return true;
  }
  bool step_until_frames(std::size_t count) {
    return step_until([&] { return frames_.size() >= count; });
  }

  net::ClientEndpoint& endpoint() { return *endpoint_; }
  const std::vector<net::ReceivedFrame>& frames() const { return frames_; }
  const std::vector<net::Welcomed>& welcomes() const { return welcomes_; }
  int stales() const { return stales_; }  ///< how often nothing had come for half a second

  /// The head turns slowly, the gaze wanders.
  net::ViewState next_view() {
    net::ViewState view;
    view.sequence = ++sequence_;
    view.sampled = view.gaze_sampled = ClientTime{clock_.now()};
    view.predicted_display = view.sampled + 14ms;
    const double turn = 0.2 * std::sin(0.01 * static_cast<double>(sequence_));
    view.stage_from_head.position = {0.0, 1.6, 0.0};
    view.stage_from_head.rotation = glm::angleAxis(turn, DVec3{0.0, 1.0, 0.0});
    for (const double side : {-1.0, 1.0}) {
      net::EyeState eye;
      eye.head_from_eye.position.x = side * 0.032;
      eye.fov = display_.fov;
      eye.gaze.direction = glm::normalize(Vec3{static_cast<float>(turn), 0.1F, -1.0F});
      view.eyes.push_back(eye);
    }
    return view;
  }

 private:
  const foveation::Display display_;
  base::SteadyClock clock_;
  std::unique_ptr<net::ClientEndpoint> endpoint_;
  std::vector<net::ReceivedFrame> frames_;
  std::vector<net::Welcomed> welcomes_;
  int stales_ = 0;
  std::uint64_t sequence_ = 0;
};

}  // namespace macula::loopback
