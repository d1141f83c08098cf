// How much light the GGX lobe reflects: its directional albedo under Schlick's Fresnel term, which
// is linear in f0 and f90, so that two tables over (cosine, alpha) hold all of it:
//   E(mu, alpha) = f0 A(mu, alpha) + f90 B(mu, alpha).
// Karis (2013), "Real Shading in Unreal Engine 4". Made once, on first use (tens of milliseconds).
#pragma once

namespace macula::shading {

struct GgxAlbedo {
  float a = 0.0F, b = 0.0F;
};

/// mu: cosine to the normal, alpha: GGX width; both clamped to [0, 1]. a + b <= 1.
GgxAlbedo ggx_albedo(float mu, float alpha);
/// Cosine-weighted hemispherical mean of the interpolated table: 2 integral E(mu) mu dmu.
GgxAlbedo ggx_mean_albedo(float alpha);

}  // namespace macula::shading
