#include "server/kernels/culling/stochastic_culling.h"

#include <cmath>
#include <numeric>

#include "shared/base/check.h"
#include "shared/image/color.h"

namespace macula::kernels::culling {
namespace {

using lights::VirtualPointLight;

/// p_i of every light; sums to 1.
std::vector<double> probabilities(std::span<const VirtualPointLight> lights,
                                  std::span<const float> contribution, double by_flux) {
  const double all = std::accumulate(contribution.begin(), contribution.end(), 0.0);
  double flux = 0.0;
  for (const VirtualPointLight& light : lights) flux += image::luminance(light.flux);
  if (!(all > 0.0)) by_flux = 1.0;
  std::vector<double> p(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    p[i] = flux > 0.0 ? by_flux * image::luminance(lights[i].flux) / flux : 0.0;
    if (by_flux < 1.0) p[i] += (1.0 - by_flux) * contribution[i] / all;
  }
  return p;
}

}  // namespace

std::vector<VirtualPointLight> cull(std::span<const VirtualPointLight> lights,
                                    std::span<const float> contribution, const Config& config,
                                    float u) {
  MACULA_CHECK(lights.size() == contribution.size() && config.kept >= 1);
  if (lights.size() <= static_cast<std::size_t>(config.kept)) return {lights.begin(), lights.end()};
  const std::vector<double> p =
      probabilities(lights, contribution, static_cast<double>(config.by_flux));
  std::vector<VirtualPointLight> kept;
  double passed = 0.0;
  double next = u;  // of `kept` equal steps
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const double expected = config.kept * p[i];
    passed += expected;
    int drawn = 0;
    for (; next < passed; next += 1.0) ++drawn;
    if (drawn == 0) continue;
    kept.push_back(lights[i]);
    if (config.weights == CullWeights::Unbiased)
      kept.back().flux *= static_cast<float>(drawn / expected);
  }
  return kept;
}

}  // namespace macula::kernels::culling
