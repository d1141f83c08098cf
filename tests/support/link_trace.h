// Recorded links for the chaos proxy: a CSV with a column t_s and either rtt_ms (half of it is the
// one-way delay; a stall is one long round trip, and order is kept, as TCP does) or capacity_mbps.
#pragma once

#include <string>

#include "tests/support/chaos_proxy.h"

namespace macula::support {

/// What the recording does not say stays as in `base`. Errors name the file and line.
Result<LinkTrace> load_link_trace(const std::string& path, const LinkShape& base = {});

}  // namespace macula::support
