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

Rgb reflect_diffusely(const shading::ReflectorBatch& reflectors, std::size_t i,
                      const Vec3& to_light, const Rgb& irradiance) {
  const float cos_l = cosine_above(reflectors, i, to_light);
  if (!(cos_l > 0.0F)) return Rgb{0.0F};
  const shading::GgxAlbedo lobe = shading::ggx_albedo(cos_l, reflectors.alpha.at[i]);
  const Rgb taken = lobe.a * reflectors.f0[i] + Rgb{lobe.b * reflectors.f90.at[i]};
  return cos_l * reflectors.diffuse[i] * (Rgb{1.0F} - taken) * irradiance;
}

}  // namespace macula::kernels::lightcuts
