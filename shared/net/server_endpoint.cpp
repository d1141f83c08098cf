#include "shared/net/server_endpoint.h"

#include <thread>
#include <utility>

#include "shared/base/check.h"
#include "shared/net/server_loop.h"

namespace macula::net {
namespace {

/// A door to the net thread: it hands commands in and events out.
class Endpoint final : public ServerEndpoint {
 public:
  explicit Endpoint(std::unique_ptr<ServerLoop> loop)
      : loop_(std::move(loop)), thread_([this] { loop_->run(); }) {}
  ~Endpoint() override {
    loop_->events().close();
    loop_->post(Stop{});
    thread_.join();
  }

  std::string endpoint() const override { return loop_->endpoint(); }
  std::string public_key_z85() const override { return loop_->public_key_z85(); }
  std::optional<ServerEvent> wait(Nanoseconds timeout) override {
    return loop_->events().wait(timeout);
  }
  void send(PeerId peer, Message message) override {
    loop_->post(SendMessage{peer, std::move(message)});
  }
  void send_frame(PeerId peer, EncodedFrame frame) override {
    MACULA_CHECK(frame.payloads.size() == frame.begin.slices.size(), "one payload a slice");
    for (std::size_t i = 0; i < frame.payloads.size(); ++i) {
      MACULA_CHECK(frame.payloads[i]->size() == frame.begin.slices[i].size_bytes,
                   "the directory states the payload's size");
    }
    loop_->post(SendFrame{peer, std::move(frame), loop_->now()});
  }
  ServerCounters counters() const override { return loop_->counters(); }

 private:
  std::unique_ptr<ServerLoop> loop_;
  std::thread thread_;
};

}  // namespace

Result<std::unique_ptr<ServerEndpoint>> ServerEndpoint::create(const ServerEndpointOptions& options,
                                                               const base::Clock& clock) {
  auto loop = ServerLoop::create(options, clock);
  if (!loop) return forward(loop);
  return std::make_unique<Endpoint>(std::move(*loop));
}

}  // namespace macula::net
