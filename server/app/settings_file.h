// A settings file: TOML with the long options as keys (underscores for dashes). An unknown key or a
// value of the wrong type is an error with file and line.
#pragma once

#include <string>
#include <vector>

#include "server/app/options.h"
#include "shared/base/result.h"

namespace macula::server_app {

/// Every key a settings file may have.
std::vector<std::string> settings_keys();

/// Overwrites what the file sets.
Result<void> apply_settings_file(const std::string& path, Options& options);

}  // namespace macula::server_app
