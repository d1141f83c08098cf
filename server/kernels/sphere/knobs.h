// Kernel `sphere`'s settings by name.
#pragma once

#include "server/kernels/knobs.h"
#include "server/kernels/sphere/config.h"

namespace macula::kernels::sphere {

Result<void> turn_knobs(std::span<const KnobValue> values, Config& config);

}  // namespace macula::kernels::sphere
