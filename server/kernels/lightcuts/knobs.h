// Kernel `lightcuts`'s settings by name.
#pragma once

#include "server/kernels/knobs.h"
#include "server/kernels/lightcuts/config.h"

namespace macula::kernels::lightcuts {

Result<void> turn_knobs(std::span<const KnobValue> values, Config& config);

}  // namespace macula::kernels::lightcuts
