// run_client: a whole run of the client over a given connection, from the first pose to the report.
// Tests call it with an endpoint of their own; main makes a real one.
#pragma once

#include <atomic>

#include "client/app/client_config.h"
#include "client/display/headless/report.h"
#include "shared/base/clock.h"
#include "shared/base/result.h"
#include "shared/net/client_endpoint.h"

namespace macula::client_app {

/// `stop` ends the run cleanly from another thread or a signal handler. What was measured is
/// returned, and written to out_folder, whichever way the run ended. Errors: a malformed trace, a
/// window that does not open, no welcome, files that cannot be written.
Result<display::ClientReport> run_client(const ClientConfig& config, net::ClientEndpoint& endpoint,
                                         const base::Clock& clock, const std::atomic<bool>& stop);

/// The same with a connection made from the config. Bad input is found before connecting.
Result<display::ClientReport> run_client(const ClientConfig& config, const base::Clock& clock,
                                         const std::atomic<bool>& stop);

}  // namespace macula::client_app
