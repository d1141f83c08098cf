// Kernel `culling`'s settings by name.
#pragma once

#include "server/kernels/culling/config.h"
#include "server/kernels/knobs.h"

namespace macula::kernels::culling {

Result<void> turn_knobs(std::span<const KnobValue> values, Config& config);

}  // namespace macula::kernels::culling
