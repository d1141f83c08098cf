// Rate models: how densely the eye needs samples at an eccentricity, in samples per nominal display
// pixel (areal), in (0, 1], never rising with eccentricity. The four papers' curves and cortical
// magnification stand behind one rate(e).
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "shared/base/result.h"
#include "shared/units/angle.h"

namespace macula::foveation {

enum class RateCurve {
  Uniform,    ///< 1 everywhere
  Lightcuts,  ///< Shi et al., Foveated Stochastic Lightcuts, Eq. 2: acuity line, e in radians
  Culling,    ///< Yang et al., Foveated Light Culling: clamp(1 + s (m - e), omega_p, 1)
  Ray,        ///< Weier et al., Foveated Real-Time Ray Tracing: ramp r0..r1 down to p_min
  Sphere,  ///< Polychronakis et al., Eq. 1 (sign corrected): 0.90964 exp(-w / 2.9661 deg) + 0.00792
  Cortical,  ///< FovVideoVDP's M_rel(e) = (3.67 / (e + 3.67 deg))^0.6046, squared for area
};

/// Everything a curve needs; unused fields keep their defaults.
struct RateModel {
  RateCurve curve = RateCurve::Cortical;
  Degrees inner{10.0};  ///< Ray: r0. Culling, Sphere: radius of the fovea that keeps rate 1
  Degrees outer{25.0};  ///< Ray: r1
  double floor = 0.02;  ///< least rate anywhere, in (0, 1]

  /// Samples per nominal display pixel at eccentricity e in [0, pi].
  double rate(Radians e) const;
};

struct RatePreset {
  std::string_view name;
  std::string_view summary;
  RateModel model;
};
/// uniform, lightcuts, culling, ray-small, ray-medium, ray-large, ray-full, sphere, cortical.
std::span<const RatePreset> rate_presets();
/// Unknown names answer with the list of names.
Result<RateModel> find_rate_model(std::string_view name);

}  // namespace macula::foveation
