#include "shared/foveation/rate.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace macula::foveation {
namespace {

// Shi et al., Eq. 2: acuity = 1.1715 - 2.45 e with e in radians; 1 up to 4.01 degrees.
double lightcuts_rate(double e_rad) {
  return 1.1715 - 2.45 * e_rad;
}

// Yang et al.: 1 + s (m - e), s = 2.25 per radian, m the fovea's angular radius.
double culling_rate(double e_rad, double fovea_rad) {
  return 1.0 + 2.25 * (fovea_rad - e_rad);
}

// Weier et al.: 1 inside r0, linear to p_min at r1. The test on r0 comes first: r0 = r1 is a step.
double ramp_rate(double e_deg, double r0_deg, double r1_deg, double p_min) {
  if (e_deg <= r0_deg) return 1.0;
  if (e_deg >= r1_deg) return p_min;
  return 1.0 - (1.0 - p_min) * (e_deg - r0_deg) / (r1_deg - r0_deg);
}

// Polychronakis et al., Eq. 1 with the exponent's sign corrected, w in degrees.
double sphere_rate(double e_deg, double fovea_deg) {
  if (e_deg <= fovea_deg) return 1.0;
  return 0.90964 * std::exp(-e_deg / 2.9661) + 0.00792;
}

// Mantiuk et al. 2021 (FovVideoVDP v1.2): relative cortical magnification, linear; its square is
// areal.
double cortical_rate(double e_deg) {
  return std::pow(3.67 / (e_deg + 3.67), 2.0 * 0.6046);
}

constexpr std::array kPresets{
    RatePreset{"cortical", "cortical magnification (FovVideoVDP), the default", RateModel{}},
    RatePreset{"uniform", "1 everywhere: an ordinary picture",
               RateModel{RateCurve::Uniform, Degrees{0.0}, Degrees{0.0}, 1.0}},
    RatePreset{"lightcuts", "acuity line of foveated stochastic lightcuts",
               RateModel{RateCurve::Lightcuts, Degrees{0.0}, Degrees{0.0}, 0.02}},
    RatePreset{"culling", "acuity line of foveated light culling",
               RateModel{RateCurve::Culling, Degrees{10.0}, Degrees{0.0}, 0.2}},
    RatePreset{"ray-small", "foveated ray tracing, r0 5, r1 10 degrees, p_min 0.01",
               RateModel{RateCurve::Ray, Degrees{5.0}, Degrees{10.0}, 0.01}},
    RatePreset{"ray-medium", "foveated ray tracing, r0 10, r1 20 degrees, p_min 0.05",
               RateModel{RateCurve::Ray, Degrees{10.0}, Degrees{20.0}, 0.05}},
    RatePreset{"ray-large", "foveated ray tracing, r0 15, r1 30 degrees, p_min 0.1",
               RateModel{RateCurve::Ray, Degrees{15.0}, Degrees{30.0}, 0.1}},
    RatePreset{"ray-full", "foveated ray tracing's full renderer: rate 1",
               RateModel{RateCurve::Ray, Degrees{180.0}, Degrees{180.0}, 1.0}},
    RatePreset{"sphere", "exponential of foveated sphere tracing, fovea 7.5 degrees",
               RateModel{RateCurve::Sphere, Degrees{7.5}, Degrees{0.0}, 0.00792}},
};

}  // namespace

double RateModel::rate(Radians e) const {
  const double e_rad = e.value(), e_deg = Degrees{e}.value();
  double wanted = 1.0;
  switch (curve) {
    case RateCurve::Uniform:
      break;
    case RateCurve::Lightcuts:
      wanted = lightcuts_rate(e_rad);
      break;
    case RateCurve::Culling:
      wanted = culling_rate(e_rad, Radians{inner}.value());
      break;
    case RateCurve::Ray:
      wanted = ramp_rate(e_deg, inner.value(), outer.value(), floor);
      break;
    case RateCurve::Sphere:
      wanted = sphere_rate(e_deg, inner.value());
      break;
    case RateCurve::Cortical:
      wanted = cortical_rate(e_deg);
      break;
  }
  // A rate of exactly 0 would ask for cells of infinite size; 1e-4 is one sample in 100 x 100
  // pixels.
  constexpr double kLeast = 1e-4;
  return std::clamp(wanted, std::clamp(floor, kLeast, 1.0), 1.0);
}

std::span<const RatePreset> rate_presets() {
  return kPresets;
}

Result<RateModel> find_rate_model(std::string_view name) {
  std::string names;
  for (const RatePreset& preset : kPresets) {
    if (preset.name == name) return preset.model;
    names += (names.empty() ? "" : ", ") + std::string(preset.name);
  }
  return base::bad_input("unknown rate model '" + std::string(name) + "'", "rate model",
                         "known: " + names);
}

}  // namespace macula::foveation
