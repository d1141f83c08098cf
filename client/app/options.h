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

struct Options {
  ClientConfig config;
  Verbosity verbosity = Verbosity::Normal;
};

/// A text to print instead of running (--help, --version).
struct TextAsked {
  std::string text;
};

Result<std::variant<Options, TextAsked>> parse_options(int argc, const char* const* argv,
                                                       const Environment& environment);

}  // namespace macula::client_app
