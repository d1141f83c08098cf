// How much light the GGX lobe reflects: its directional albedo under Schlick's Fresnel term, which
// is linear in f0 and f90, so that two tables over (cosine, alpha) hold all of it:
//   E(mu, alpha) = f0 A(mu, alpha) + f90 B(mu, alpha).
// Karis (2013), "Real Shading in Unreal Engine 4". Made once, on first use (tens of milliseconds).
#pragma once

#include <cstdint>

namespace macula::shading {

struct GgxAlbedo {
  float a = 0.0F, b = 0.0F;
};

/// mu: cosine to the normal, alpha: GGX width; both clamped to [0, 1]. a + b <= 1.
GgxAlbedo ggx_albedo(float mu, float alpha);
/// The table of ggx_albedo for loops that gather: entry (i, j), at j * kNodes + i, is for the mu of
/// node i and the alpha of node j, where node n stands for (n / (kNodes - 1))^2; a in its lower and
/// b in its upper 16 bits, in units of 1/65535.
struct GgxAlbedoNodes {
  static constexpr int kNodes = 32;  ///< linear interpolation errs below 3e-3 (tested)
  static const std::int32_t* packed();
  /// The same in floats, a and b after each other; and of ggx_mean_albedo, by the node of alpha.
  static const float* directional();
  static const float* mean();
};
/// Cosine-weighted hemispherical mean of the interpolated table: 2 integral E(mu) mu dmu.
GgxAlbedo ggx_mean_albedo(float alpha);

}  // namespace macula::shading
