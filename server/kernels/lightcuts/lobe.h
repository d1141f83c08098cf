// The lobe of a reflector apart from the diffuse part under it: which lobes are narrow enough for
// rays that follow them, a direction of one, and what is left without it. World, unit directions.
#pragma once

#include <optional>

#include "server/shading/reflector_batch.h"

namespace macula::kernels::lightcuts {

/// Widest lobe (GGX alpha, roughness .5) that shows what it reflects; wider ones look like a matt
/// surface's light.
inline constexpr float kWidestGloss = 0.25F;
/// alpha: of ReflectorBatch, 0 without a lobe.
inline bool is_glossy(float alpha) {
  return alpha > 0.0F && alpha <= kWidestGloss;
}

/// Lobes so narrow (roughness .15) that a light which is drawn without regard to them hardly ever
/// lies in one: lamps with an extent are met by rays that follow them.
inline constexpr float kWidestMirror = 0.0225F;
inline bool is_mirror(float alpha) {
  return alpha > 0.0F && alpha <= kWidestMirror;
}

struct LobeSample {
  Vec3 to_light{0.0F};
  Rgb weight{0.0F};  ///< of the lobe alone: f cos / pdf
};
/// A direction of reflector i's lobe, by visible normals (Heitz 2018), u in [0, 1)^2; none where it
/// lies below either normal. Only for alpha > 0.
std::optional<LobeSample> sample_lobe(const shading::ReflectorBatch& reflectors, std::size_t i,
                                      const Vec2& u);
/// Density of sample_lobe() in 1/sr.
float lobe_density(const shading::ReflectorBatch& reflectors, std::size_t i, const Vec3& to_light);
/// Which part of what a lamp's triangle shines into reflector i's lobe its rays bring; the rest is
/// the cuts'. Any function of the direction and the distance alone leaves the mean as it is
/// (multiple importance sampling, power heuristic): it only has to know which of both finds such
/// a lamp more easily. `lamp_area_m2`: the scene's (lamp_area()).
float share_of_rays(const shading::ReflectorBatch& reflectors, std::size_t i, const Vec3& to_light,
                    float distance2_m2, float lamp_area_m2);
/// What the diffuse part under reflector i's lobe alone reflects: as shading::reflect less the
/// lobe.
Rgb reflect_diffusely(const shading::ReflectorBatch& reflectors, std::size_t i,
                      const Vec3& to_light, const Rgb& irradiance);

}  // namespace macula::kernels::lightcuts
