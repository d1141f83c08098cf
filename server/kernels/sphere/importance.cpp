#include "server/kernels/sphere/importance.h"

#include <algorithm>
#include <cmath>

#include "server/sampling/blue_noise.h"
#include "server/sampling/sample.h"

namespace macula::kernels::sphere {

double acuity(Degrees eccentricity) {
  return 0.90964 * std::exp(-eccentricity.value() / 2.9661) + 0.00792;
}

double importance(Degrees eccentricity, float edge, const MaskConfig& config) {
  const double e = eccentricity.value(), fovea = config.fovea.value();
  if (config.rule == MaskRule::Literal) {
    if (e <= fovea) return edge;  // a product with the edges, also where acuity is 1
    return e > config.outer.value() ? 0.0 : acuity(eccentricity) * edge;
  }
  if (e <= fovea) return 1.0;
  if (e > config.outer.value()) return 0.0;
  const Degrees from_origin{config.origin == AcuityOrigin::FoveaRim ? e - fovea : e};
  return acuity(from_origin) * std::max(edge, config.flat_share);
}

float threshold(int x, int y, std::uint64_t frame, std::uint64_t seed, MaskRule rule) {
  if (rule == MaskRule::Corrected) return sampling::BlueNoise::get().threshold(x, y, frame);
  const auto cell = static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32U |
                    static_cast<std::uint32_t>(x);
  return sampling::sample(sampling::SampleKey(seed, frame, cell), 0);
}

}  // namespace macula::kernels::sphere
