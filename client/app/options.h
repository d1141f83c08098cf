// The command line of macula-client. Everything that can be known to be wrong before connecting is
// an Error here: unknown options, values out of range, unknown names.
#pragma once

#include <string>
#include <variant>

#include "client/app/client_config.h"
#include "shared/base/result.h"

namespace macula::client_app {

/// What main reads from the environment for defaults; null where unset.
struct Environment {
  const char* xdg_config_home = nullptr;
  const char* home = nullptr;
  const char* display = nullptr;  ///< an X server; without one the default is headless
  const char* wayland_display = nullptr;
};

enum class Verbosity { Normal, Verbose };

enum class Task { Show, Examine };

struct Options {
  ClientConfig config;
  Verbosity verbosity = Verbosity::Normal;
  Task task = Task::Show;
};

/// A text to print instead of running (--help, --version).
struct TextAsked {
  std::string text;
};

/// 'macula-client pair': learn a server's key, and be let in, by its code.
struct PairCommand {
  std::string connect;  ///< the pairing socket
  std::string key_folder;
  std::string code;  ///< as typed; empty: ask
  std::string name;  ///< empty: what the machine calls itself
};
using Command = std::variant<Options, TextAsked, PairCommand>;

Result<Command> parse_options(int argc, const char* const* argv, const Environment& environment);

}  // namespace macula::client_app
