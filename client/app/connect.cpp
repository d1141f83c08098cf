#include "client/app/connect.h"

#include <optional>
#include <thread>
#include <variant>

#include "shared/base/log.h"
#include "shared/base/text.h"

namespace macula::client_app {
namespace {

template <class... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};

bool is_final(net::RefusalCode code) {
  return code == net::RefusalCode::VersionMismatch || code == net::RefusalCode::BadRequest;
}

std::string seconds(Nanoseconds duration) {
  return base::concat(units::to_s(duration), " s");
}

Error nobody_answered(const std::string& connect, Nanoseconds patience,
                      const std::string& last_word) {
  if (!last_word.empty()) return {last_word, connect, "", base::ErrorKind::Runtime};
  return {"no answer within " + seconds(patience), connect,
          "is macula-server running there? compare its --bind with this program's --connect, and "
          "both programs' --keys",
          base::ErrorKind::Runtime};
}

}  // namespace

Result<net::Welcome> wait_for_welcome(net::ClientEndpoint& endpoint, const base::Clock& clock,
                                      const std::string& connect, Nanoseconds patience,
                                      const std::atomic<bool>& stop) {
  const Nanoseconds give_up = clock.now() + patience;
  std::string last_word;
  while (clock.now() < give_up) {
    if (stop) return base::runtime_error("interrupted while connecting", connect);
    const auto event = endpoint.take_event();
    if (!event) {
      std::this_thread::sleep_for(std::chrono::milliseconds{5});
      continue;
    }
    if (const auto* welcomed = std::get_if<net::Welcomed>(&*event)) return welcomed->welcome;
    if (const auto* refused = std::get_if<net::Refused>(&*event)) {
      last_word = refused->refusal.text;
      if (is_final(refused->refusal.code)) return base::runtime_error(last_word, connect);
    }
    log_event(*event);
  }
  return tl::unexpected(nobody_answered(connect, patience, last_word));
}

void log_event(const net::ClientEvent& event) {
  std::visit(Overloaded{
                 [](const net::Welcomed& e) {
                   base::log_info(e.resumed ? "the session goes on after a reconnection"
                                            : "the server began a new session");
                 },
                 [](const net::Refused& e) { base::log_warning("refused: " + e.refusal.text); },
                 [](const net::Stale&) {
                   base::log_warning("nothing from the server for 500 ms; showing the last frame");
                 },
                 [](const net::Fresh&) { base::log_info("the server is back"); },
                 [](const net::Disconnected& e) { base::log_warning("disconnected: " + e.text); },
             },
             event);
}

}  // namespace macula::client_app
