// What macula-server understands on its command line, in the groups that its help shows.
#pragma once

#include "server/app/options.h"

namespace CLI {
class App;
}

namespace macula::server_app {

/// Each option goes to its member, which also holds its default. `app` keeps references.
void declare_options(CLI::App& app, Options& options);

}  // namespace macula::server_app
