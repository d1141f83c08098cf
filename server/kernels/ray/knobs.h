// Kernel `ray`'s settings by name.
#pragma once

#include "server/kernels/knobs.h"
#include "server/kernels/ray/config.h"

namespace macula::kernels::ray {

Result<void> turn_knobs(std::span<const KnobValue> values, Config& config);

// What kernels that light as `ray` does share with it.
bool turn_samples(Config& config, std::string_view value);
bool turn_lights(Config& config, std::string_view value);
bool turn_ambient(Config& config, std::string_view value);
bool turn_environment(Config& config, std::string_view value);
inline constexpr std::string_view kSamplesAllowed = "1 to 1024", kLightsAllowed = "1 to 1024",
                                  kAmbientAllowed = "0 to 1024";

}  // namespace macula::kernels::ray
