// A server and clients on loopback with keys in a folder of their own, and frames to send. For
// tests of the wire; sessions are played by the test itself.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <iterator>
#include <random>
#include <string>
#include <thread>

#include "shared/net/client_endpoint.h"
#include "shared/net/keys.h"
#include "shared/net/server_endpoint.h"
#include "tests/support/temporary_folder.h"

namespace macula::net {

using namespace std::chrono_literals;

using test::TemporaryFolder;

/// Of this process.
inline int open_descriptors() {
  const std::filesystem::directory_iterator open("/proc/self/fd");
  return static_cast<int>(std::distance(open, std::filesystem::directory_iterator()));
}

inline foveation::Display small_display() {
  return {math::symmetric_fov(Degrees{90.0}, 1.0), 64, 64};
}

/// Tries again until `done` holds or `patience` is over.
template <class Done>
bool eventually(Done&& done, std::chrono::milliseconds patience = 20s) {
  const auto until = std::chrono::steady_clock::now() + patience;
  while (!done()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(1ms);
  }
  return true;
}

/// A frame of one view and one colour slice of `bytes` random bytes.
inline EncodedFrame make_frame(std::uint32_t epoch, std::uint64_t frame, std::size_t bytes,
                               std::uint64_t seed = 1) {
  std::mt19937_64 random(seed + frame);
  auto payload = std::make_shared<std::vector<std::byte>>(bytes);
  for (std::byte& byte : *payload) byte = static_cast<std::byte>(random());
  EncodedFrame encoded;
  encoded.begin.epoch = encoded.end.epoch = epoch;
  encoded.begin.frame = encoded.end.frame = frame;
  FrameView view;
  view.display_fov = small_display().fov;
  view.grid = foveation::make_uniform_grid(small_display());
  encoded.begin.views.push_back(view);
  encoded.begin.slices.push_back({0,
                                  0,
                                  PlaneKind::Color,
                                  SliceCodec::Jpeg,
                                  {0, 0, 64, 64},
                                  static_cast<std::uint32_t>(bytes)});
  encoded.payloads.push_back(std::move(payload));
  return encoded;
}

inline ViewState make_view(std::uint64_t sequence) {
  ViewState view;
  view.sequence = sequence;
  view.eyes.push_back({{}, small_display().fov, {}});
  return view;
}

/// The least session: welcomes every Hello and remembers who is there.
class PlainServer {
 public:
  explicit PlainServer(const std::string& folder, const std::string& bind = "tcp://127.0.0.1:*",
                       const ServerDelays& delays = {}) {
    ServerEndpointOptions options;
    options.bind = bind;
    options.key_folder = folder;
    options.delays = delays;
    auto created = ServerEndpoint::create(options, clock_);
    EXPECT_TRUE(created) << (created ? "" : created.error().message());
    endpoint_ = std::move(*created);
  }

  ServerEndpoint& endpoint() { return *endpoint_; }
  ServerTime now() const { return ServerTime{clock_.now()}; }

  /// Handles events until one of type T comes.
  template <class T>
  std::optional<T> next(std::chrono::milliseconds patience = 20s) {
    const auto until = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < until) {
      auto event = endpoint_->wait(std::min<Nanoseconds>(20ms, patience));
      if (!event) continue;
      if (const auto* const hello = std::get_if<HelloReceived>(&*event)) welcome(*hello);
      if (auto* const wanted = std::get_if<T>(&*event)) return std::move(*wanted);
    }
    return std::nullopt;
  }
  void welcome(const HelloReceived& hello) {
    peer_ = hello.peer;
    Welcome welcome;
    welcome.session = 77;
    welcome.epoch = ++epoch_;
    welcome.color_codec = "jpeg";
    endpoint_->send(hello.peer, welcome);
  }
  std::uint32_t epoch() const { return epoch_; }
  /// Who said Hello last.
  PeerId peer() const { return peer_; }

 private:
  base::SteadyClock clock_;
  std::unique_ptr<ServerEndpoint> endpoint_;
  std::uint32_t epoch_ = 100;
  PeerId peer_;
};

inline ClientEndpointOptions client_options(const std::string& connect, const std::string& folder) {
  ClientEndpointOptions options;
  options.connect = connect;
  options.key_folder = folder;
  options.hello.program = "test";
  options.hello.eyes = {small_display()};
  options.hello.codecs = {"jpeg"};
  return options;
}

inline std::unique_ptr<ClientEndpoint> make_client(const ClientEndpointOptions& options) {
  static const base::SteadyClock clock;
  auto created = ClientEndpoint::create(options, clock);
  EXPECT_TRUE(created) << (created ? "" : created.error().message());
  return created ? std::move(*created) : nullptr;
}

/// The next event of type T, dropping others.
template <class T>
std::optional<T> next_event(ClientEndpoint& client, std::chrono::milliseconds patience = 20s) {
  std::optional<T> found;
  eventually(
      [&] {
        while (auto event = client.take_event()) {
          if (auto* const wanted = std::get_if<T>(&*event)) {
            found = std::move(*wanted);
            return true;
          }
        }
        return false;
      },
      patience);
  return found;
}

/// Server and client have met: the newest Hello is welcomed and the client knows it. A client on a
/// busy machine may connect more than once before that.
inline bool meet(PlainServer& server, ClientEndpoint& client) {
  return eventually([&] {
    server.next<HelloReceived>(1ms);
    while (const auto event = client.take_event()) {
      const auto* const welcomed = std::get_if<Welcomed>(&*event);
      if (welcomed != nullptr && welcomed->welcome.epoch == server.epoch()) return true;
    }
    return false;
  });
}

}  // namespace macula::net
