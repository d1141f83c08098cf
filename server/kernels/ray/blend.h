// How a new sample joins what is remembered of its cell: the formulas of section 3.4 with the
// corrections and guards that README.md lists. Pure functions.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "server/kernels/ray/foveated_config.h"

namespace macula::kernels::ray {

/// k_t: least weight of a new sample that meets a memory of `age` frames, k_min^(1-y) k_max^y with
/// y = (age - 1) / (t_max - 1) in [0, 1]; ages below 1 count as 1, t_max <= 1 is always k_max.
float least_weight(const AgeLimits& limits, std::uint32_t age);

/// alpha_t of a sample that meets the mean of `samples` (rho >= 0) earlier ones; 1 for none.
inline float weight(float samples, float limit, WeightRule rule) {
  const float mean = 1.0F / (samples + 1.0F);
  return rule == WeightRule::AtMostLimit ? std::min(mean, limit) : std::max(mean, limit);
}

/// rho_t: how many independent samples the blend is worth: 1 / (a^2 + (1 - a)^2 / rho); 1 where
/// nothing was remembered.
inline float samples_after(float samples, float alpha) {
  if (!(samples > 0.0F)) return 1.0F;
  const float rest = 1.0F - alpha;
  return 1.0F / (alpha * alpha + rest * rest / samples);
}

/// least_weight() of every age.
class LimitTable {
 public:
  explicit LimitTable(const AgeLimits& limits);
  float at(std::uint32_t age) const { return age < weights_.size() ? weights_[age] : most_; }

 private:
  float most_;
  std::vector<float> weights_;
};

}  // namespace macula::kernels::ray
