#include "shared/net/client_endpoint.h"

#include <thread>
#include <utility>

#include "shared/net/client_loop.h"

namespace macula::net {
namespace {

/// A door to the net thread.
class Endpoint final : public ClientEndpoint {
 public:
  explicit Endpoint(std::unique_ptr<ClientLoop> loop)
      : loop_(std::move(loop)), thread_([this] { loop_->run(); }) {}
  ~Endpoint() override {
    loop_->stop();
    thread_.join();
  }

  void publish(ViewState view) override { loop_->publish(std::move(view)); }
  void send(Message settings_or_bye) override { loop_->send(std::move(settings_or_bye)); }
  std::optional<ReceivedFrame> wait_frame(Nanoseconds timeout) override {
    return loop_->frames().wait(timeout);
  }
  void request_key() override { loop_->request_key(); }
  std::optional<ClientEvent> take_event() override { return loop_->events().take(); }
  std::optional<ClockEstimate> clock() const override { return loop_->clock(); }
  ClientCounters counters() const override { return loop_->counters(); }

 private:
  std::unique_ptr<ClientLoop> loop_;
  std::thread thread_;
};

Result<ClientLink::Options> link_options(const ClientEndpointOptions& options) {
  const auto keys = load_or_make_keys(options.key_folder, Role::Client);
  if (!keys) return forward(keys);
  const std::string server_file = options.key_folder + "/server.pub";
  const std::string key_source =
      options.server_key_z85.empty() ? server_file : "the server key given";
  std::string server_key = options.server_key_z85;
  if (server_key.empty()) {
    auto loaded = load_public_key(server_file);
    if (!loaded) {
      Error error = loaded.error();
      error.remedy =
          "run 'macula-server pair' there and 'macula-client pair' here, or copy server.pub from "
          "the key folder of the server's machine to this file";
      return tl::unexpected<Error>(error);
    }
    server_key = std::move(*loaded);
  }
  if (!is_key(server_key)) {
    return base::bad_input("not a key", key_source, "40 characters of Z85 text");
  }
  return ClientLink::Options{{options.connect, options.key_folder + "/client.pub", key_source},
                             *keys,
                             server_key,
                             options.limits};
}

}  // namespace

Result<std::unique_ptr<ClientEndpoint>> ClientEndpoint::create(const ClientEndpointOptions& options,
                                                               const base::Clock& clock) {
  auto link = link_options(options);
  if (!link) return forward(link);
  auto loop = std::make_unique<ClientLoop>(options, std::move(*link), clock);
  if (auto opened = loop->open(); !opened) return forward(opened);
  return std::make_unique<Endpoint>(std::move(loop));
}

}  // namespace macula::net
