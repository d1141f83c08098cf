// Stochastic culling (section 3.4): which virtual lights are kept, and for how many each counts.
// Pure.
#pragma once

#include <span>
#include <vector>

#include "server/kernels/culling/config.h"

namespace macula::kernels::culling {

/// At most config.kept of the lights, in their order, their fluxes scaled by weights. Light i is
/// drawn config.kept p_i times on average, p_i = (1 - by_flux) C_i / sum C + by_flux F_i / sum F, F
/// the flux's luminance, and counts n_i / (kept p_i) times if it was drawn n_i times: each light's
/// mean weight is
/// 1. Where all contributions are 0, by flux alone. Draws are systematic, u in [0, 1). With no more
/// lights than `kept`, all stay as they are. contribution.size() == lights.size(), values >= 0.
std::vector<lights::VirtualPointLight> cull(std::span<const lights::VirtualPointLight> lights,
                                            std::span<const float> contribution,
                                            const Config& config, float u);

}  // namespace macula::kernels::culling
