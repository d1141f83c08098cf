// Waiting for the server's welcome, and what its events mean in words.
#pragma once

#include <atomic>

#include "shared/base/clock.h"
#include "shared/base/result.h"
#include "shared/net/client_endpoint.h"

namespace macula::client_app {

/// Until welcomed. A refusal that waiting cannot cure ends it at once; one that it may (an unknown
/// key that is allowed later, a full server) is told and waited out. Errors: the refusal's own
/// sentence, or that nobody answered at `connect` within `patience` and what to do; interrupted by
/// `stop`.
Result<net::Welcome> wait_for_welcome(net::ClientEndpoint& endpoint, const base::Clock& clock,
                                      const std::string& connect, Nanoseconds patience,
                                      const std::atomic<bool>& stop);

/// One line of the log for an event of the connection.
void log_event(const net::ClientEvent& event);

}  // namespace macula::client_app
