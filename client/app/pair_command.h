// 'macula-client pair' as a person sees it.
#pragma once

#include <atomic>

#include "client/app/options.h"
#include "shared/base/clock.h"
#include "shared/base/result.h"

namespace macula::client_app {

/// Asks for the code on stdin when none was given, pairs, and says what to do next.
Result<void> run_pair(const PairCommand& command, const base::Clock& clock,
                      const std::atomic<bool>& stop);

}  // namespace macula::client_app
