// `macula-bench lightcuts --stereo`: what a pair of eyes costs, and how far off the second is, with
// and without the light that the first has found.
#pragma once

#include "tests/bench/lightcuts.h"

namespace macula::bench {

/// A table, and the report if it is asked for; methods that smooth, or those asked for. Errors as
/// run_lightcuts.
Result<void> run_lightcuts_stereo(const LightcutsOptions& options);

}  // namespace macula::bench
