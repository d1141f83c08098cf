#include "client/app/pair_command.h"

#include <unistd.h>

#include <array>
#include <iostream>

#include "shared/net/pairing_socket.h"

namespace macula::client_app {
namespace {

std::string machine_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "client";
}

Result<pairing::Code> code_of(const PairCommand& command) {
  std::string typed = command.code;
  if (typed.empty()) {
    std::cout << "code that the server shows: " << std::flush;
    std::getline(std::cin, typed);
  }
  return pairing::Code::parse(typed);
}

}  // namespace

Result<void> run_pair(const PairCommand& command, const base::Clock& clock,
                      const std::atomic<bool>& stop) {
  const auto code = code_of(command);
  if (!code) return base::forward(code);
  net::PairingGuestOptions options;
  options.connect = command.connect;
  options.key_folder = command.key_folder;
  options.name = command.name.empty() ? machine_name() : command.name;
  const auto host = net::pair_with_server(options, *code, clock, stop);
  if (!host) return base::forward(host);
  std::cout << "paired: this machine knows the server's key now (" << command.key_folder
            << "/server.pub) and may connect to it\n"
            << "start with: macula-client --connect tcp://SERVER:7788\n";
  return {};
}

}  // namespace macula::client_app
