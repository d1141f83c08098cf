#include "server/kernels/ray/blend.h"

#include <algorithm>
#include <cmath>

namespace macula::kernels::ray {

float least_weight(const AgeLimits& limits, std::uint32_t age) {
  if (limits.full_age <= 1) return limits.most;
  const float y =
      static_cast<float>(std::max(age, 1U) - 1U) / static_cast<float>(limits.full_age - 1);
  return limits.least * std::pow(limits.most / limits.least, std::min(y, 1.0F));
}

float weight(float samples, float limit, WeightRule rule) {
  const float mean = 1.0F / (samples + 1.0F);
  if (rule == WeightRule::AtMostLimit) return std::min(mean, limit);
  return std::max(mean, limit);
}

float samples_after(float samples, float alpha) {
  if (!(samples > 0.0F)) return 1.0F;
  const float rest = 1.0F - alpha;
  return 1.0F / (alpha * alpha + rest * rest / samples);
}

}  // namespace macula::kernels::ray
