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

LimitTable::LimitTable(const AgeLimits& limits) : most_(least_weight(limits, ~0U)) {
  for (int age = 0; age < limits.full_age; ++age) {
    weights_.push_back(least_weight(limits, static_cast<std::uint32_t>(age)));
  }
}

}  // namespace macula::kernels::ray
