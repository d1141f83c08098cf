// 'macula-server pair' and 'macula-server clients': what a person sees of keys.
#include <unistd.h>

#include <array>
#include <iostream>

#include "server/app/app.h"
#include "shared/base/log.h"
#include "shared/base/text.h"
#include "shared/net/keys.h"
#include "shared/net/pairing_socket.h"

namespace macula::server_app {
namespace {

std::string machine_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "this-machine";
}

/// Where clients elsewhere find `endpoint`: every address is this machine's name to them.
std::string seen_from_elsewhere(std::string endpoint) {
  for (const std::string any : {"0.0.0.0", "[::]"}) {
    const std::size_t at = endpoint.find("//" + any + ":");
    if (at != std::string::npos) endpoint.replace(at + 2, any.size(), machine_name());
  }
  return endpoint;
}

std::string key_folder(const std::string& asked, const Environment& environment) {
  return asked.empty() ? environment.default_key_folder : asked;
}

/// Says what changed since it last looked: a new code, a wrong one, a lockout.
class Announcer {
 public:
  void look(const pairing::Host& host, Nanoseconds now) {
    if (host.counters().wrong_codes != wrong_) {
      wrong_ = host.counters().wrong_codes;
      std::cout << "a wrong code was tried (" << wrong_ << " so far)" << std::endl;
    }
    const auto code = host.code(now);
    if (code == shown_) return;
    shown_ = code;
    if (code)
      std::cout << "code: " << code->spaced() << std::endl;
    else if (host.is_open(now))
      std::cout << "too many wrong codes: nobody may try for a minute, then there is a new code"
                << std::endl;
  }

 private:
  std::optional<pairing::Code> shown_;
  std::uint64_t wrong_ = 0;
};

void print_instructions(const net::PairingHost& host, Nanoseconds left) {
  std::cout << "pairing on " << host.endpoint() << " for " << units::to_s(left) << " s\n"
            << "run this on the client's machine and type the code there:\n"
            << "  macula-client pair --connect " << seen_from_elsewhere(host.endpoint())
            << std::endl;
}

Result<void> nobody_paired() {
  return base::runtime_error("nobody was paired", {}, "run it again for another two minutes");
}

}  // namespace

Result<void> run_pair(const PairCommand& command, const Environment& environment,
                      StopSignal& stop) {
  constexpr std::chrono::milliseconds kLook{100};
  base::set_log_level(base::LogLevel::Warning);
  const base::SteadyClock clock;
  net::PairingHostOptions options;
  options.bind = command.bind;
  options.key_folder = key_folder(command.keys, environment);
  auto host = net::PairingHost::create(options, clock);
  if (!host) return base::forward(host);
  const pairing::Host& state = (*host)->state();
  print_instructions(**host, state.left(clock.now()));
  stop.serving();
  Announcer announcer;
  while (state.is_open(clock.now()) && !stop.wait_for({})) {
    announcer.look(state, clock.now());
    auto paired = (*host)->serve(kLook);
    if (!paired) return base::forward(paired);
    if (!*paired) continue;
    std::cout << "paired: '" << **paired << "' may connect to servers that use "
              << options.key_folder << "; no restart is needed" << std::endl;
    return {};
  }
  return nobody_paired();
}

Result<void> run_clients(const ClientsCommand& command, const Environment& environment) {
  const std::string folder = key_folder(command.keys, environment);
  if (!command.revoke.empty()) {
    if (auto revoked = net::revoke_client(folder, command.revoke); !revoked) return revoked;
    std::cout << "'" << command.revoke << "' may no longer connect\n";
    return {};
  }
  const auto clients = net::list_clients(folder);
  for (const net::AllowedClient& client : clients)
    std::cout << client.name << "\t"
              << (client.public_z85.empty() ? "(no key in its file)" : client.public_z85) << "\n";
  if (clients.empty())
    std::cout << "no client is allowed besides this machine's own: run 'macula-server pair'\n";
  return {};
}

}  // namespace macula::server_app
