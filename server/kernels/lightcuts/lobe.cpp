#include "server/kernels/lightcuts/lobe.h"

#include <algorithm>

#include "server/sampling/frame.h"
#include "server/shading/ggx.h"
#include "server/shading/ggx_albedo.h"

namespace macula::kernels::lightcuts {
namespace {

/// Of light from `to_light` at the shading normal; 0 below either normal.
float cosine_above(const shading::ReflectorBatch& reflectors, std::size_t i, const Vec3& to_light) {
  if (glm::dot(reflectors.geometric[i], to_light) <= 0.0F) return 0.0F;
  return std::clamp(glm::dot(reflectors.shading[i], to_light), 0.0F, 1.0F);
}

}  // namespace

std::optional<LobeSample> sample_lobe(const shading::ReflectorBatch& reflectors, std::size_t i,
                                      const Vec2& u) {
  const float alpha = reflectors.alpha.at[i], cos_v = reflectors.cos_v.at[i];
  const Vec3 to_eye = reflectors.to_eye[i];
  const Mat3 frame = sampling::frame_from_normal(reflectors.shading[i]);
  const Vec3 view = to_eye * frame;  // row vector: times the transpose
  const Vec3 half = frame * shading::ggx_sample_half({view.x, view.y, cos_v}, alpha, u);
  const float cos_vh = glm::dot(to_eye, half);
  LobeSample sample;
  sample.to_light = glm::normalize(2.0F * cos_vh * half - to_eye);
  const float cos_l = cosine_above(reflectors, i, sample.to_light);
  if (!(cos_l > 0.0F)) return std::nullopt;
  // D is in both the lobe and the density: G2 / (4 cos_v cos_l) cos_l / (G1 / (4 cos_v)).
  const float shadowed = 4.0F * cos_v * cos_l * (1.0F + shading::ggx_lambda(cos_v, alpha)) *
                         shading::ggx_visibility(cos_v, cos_l, alpha);
  const Rgb f0 = reflectors.f0[i];
  const Rgb fresnel =
      f0 + (Rgb{reflectors.f90.at[i]} - f0) * shading::schlick_weight(std::min(cos_vh, 1.0F));
  sample.weight = shadowed * fresnel;
  return sample;
}

float lobe_density(const shading::ReflectorBatch& reflectors, std::size_t i, const Vec3& to_light) {
  const Vec3 half = glm::normalize(to_light + reflectors.to_eye[i]);
  return shading::ggx_reflection_pdf(reflectors.cos_v.at[i], glm::dot(reflectors.shading[i], half),
                                     reflectors.alpha.at[i]);
}

float share_of_rays(const shading::ReflectorBatch& reflectors, std::size_t i, const Vec3& to_light,
                    float distance2_m2, float lamp_area_m2) {
  if (is_mirror(reflectors.alpha.at[i])) return 1.0F;
  // That a node's draw is the very triangle: .01 close to a lamp, .0001 two meters from a small one
  // (measured among a quarter of a million).
  constexpr float kChance = 5e-4F;
  const float of_rays = lobe_density(reflectors, i, to_light) * lamp_area_m2;
  const float of_cuts = kChance * distance2_m2;
  const float a = of_rays * of_rays, b = of_cuts * of_cuts;
  return a + b > 0.0F ? a / (a + b) : 0.0F;
}

Rgb reflect_diffusely(const shading::ReflectorBatch& reflectors, std::size_t i,
                      const Vec3& to_light, const Rgb& irradiance) {
  const float cos_l = cosine_above(reflectors, i, to_light);
  if (!(cos_l > 0.0F)) return Rgb{0.0F};
  const shading::GgxAlbedo lobe = shading::ggx_albedo(cos_l, reflectors.alpha.at[i]);
  const Rgb taken = lobe.a * reflectors.f0[i] + Rgb{lobe.b * reflectors.f90.at[i]};
  return cos_l * reflectors.diffuse[i] * (Rgb{1.0F} - taken) * irradiance;
}

}  // namespace macula::kernels::lightcuts
