#include "server/shading/bsdf.h"

#include <algorithm>
#include <cmath>

#include "server/sampling/frame.h"
#include "server/sampling/mappings.h"
#include "server/shading/ggx.h"
#include "server/shading/ggx_albedo.h"
#include "server/shading/phong.h"

namespace macula::shading {
namespace {

/// Least cosine between shading normal and eye after bending: 0.06 degrees above the horizon.
constexpr float kLeastCosine = 1e-3F;

Vec3 to_local(const Vec3& world, const Vec3& normal) {
  return world * sampling::frame_from_normal(normal);  // row vector: times the transpose
}

Rgb lobe_albedo(const Bsdf& bsdf, const GgxAlbedo& parts) {
  return bsdf.f0 * parts.a + bsdf.f90 * parts.b;
}

}  // namespace

ShadingFrame make_shading_frame(const Vec3& geometric, const Vec3& shading, const Vec3& to_eye) {
  ShadingFrame frame;
  frame.to_eye = to_eye;
  frame.geometric = glm::dot(geometric, to_eye) < 0.0F ? -geometric : geometric;
  frame.shading = glm::dot(shading, frame.geometric) < 0.0F ? -shading : shading;
  const float cosine = glm::dot(frame.shading, to_eye);
  if (cosine < kLeastCosine) {
    frame.shading = glm::normalize(frame.shading + (kLeastCosine - cosine) * to_eye);
  }
  return frame;
}

Reflector::Reflector(const Bsdf& bsdf, const ShadingFrame& frame)
    : bsdf_(bsdf), frame_(frame), glossy_(bsdf.glossy()) {
  cos_v_ = std::clamp(glm::dot(frame.shading, frame.to_eye), kLeastCosine, 1.0F);
  if (!glossy_) {
    diffuse_ = bsdf.albedo / kPi;
    reflectance_ = bsdf.albedo;
    return;
  }
  if (bsdf.lobe == LobeModel::Phong) {
    const Rgb passed = bsdf.albedo * (Rgb{1.0F} - bsdf.f0);
    diffuse_ = passed / kPi;
    share_between(bsdf.f0, passed);
    return;
  }
  const Rgb lobe = lobe_albedo(bsdf, ggx_albedo(cos_v_, bsdf.alpha));
  const Rgb mean = lobe_albedo(bsdf, ggx_mean_albedo(bsdf.alpha));
  const Rgb passed = bsdf.albedo * (Rgb{1.0F} - lobe);
  // A lobe that reflects everything leaves no diffuse part: the quotient tends to 0 with it.
  diffuse_ = passed / (kPi * glm::max(Rgb{1.0F} - mean, Rgb{1e-4F}));
  share_between(lobe, passed);
}

void Reflector::share_between(const Rgb& lobe, const Rgb& passed) {
  reflectance_ = lobe + passed;
  const float lobe_weight = image::luminance(lobe);
  const float total = lobe_weight + image::luminance(passed);
  lobe_share_ = total > 0.0F ? lobe_weight / total : 1.0F;
}

Rgb Reflector::evaluate(const Vec3& to_light) const {
  const float cos_l = glm::dot(frame_.shading, to_light);
  if (cos_l <= 0.0F || glm::dot(frame_.geometric, to_light) <= 0.0F) return Rgb{0.0F};
  if (!glossy_) return diffuse_ * cos_l;
  return bsdf_.lobe == LobeModel::Phong ? evaluate_phong(to_light, cos_l)
                                        : evaluate_lobe(to_light, std::min(cos_l, 1.0F));
}

Rgb Reflector::evaluate_phong(const Vec3& to_light, float cos_l) const {
  const float exponent = phong_exponent(bsdf_.alpha);
  const float power = phong_power(mirrored(frame_.to_eye, frame_.shading), to_light, exponent);
  return (diffuse_ + phong_lobe(power, exponent) * bsdf_.f0) * cos_l;
}

Rgb Reflector::evaluate_lobe(const Vec3& to_light, float cos_l) const {
  const Rgb taken = lobe_albedo(bsdf_, ggx_albedo(cos_l, bsdf_.alpha));
  const Vec3 half = glm::normalize(frame_.to_eye + to_light);
  const float cos_vh = glm::dot(frame_.to_eye, half);
  const Rgb fresnel = bsdf_.f0 + (Rgb{bsdf_.f90} - bsdf_.f0) * schlick_weight(cos_vh);
  const float lobe = ggx_distribution(glm::dot(frame_.shading, half), bsdf_.alpha) *
                     ggx_visibility(cos_v_, cos_l, bsdf_.alpha);
  return (lobe * fresnel + diffuse_ * (Rgb{1.0F} - taken)) * cos_l;
}

Vec3 Reflector::sample_direction(const Vec3& u) const {
  if (u.x >= lobe_share_) {
    return sampling::frame_from_normal(frame_.shading) * sampling::cosine_hemisphere({u.y, u.z});
  }
  return sample_lobe({u.y, u.z});
}

Vec3 Reflector::sample_lobe(const Vec2& u) const {
  if (bsdf_.lobe == LobeModel::Phong) {
    return sampling::frame_from_normal(mirrored(frame_.to_eye, frame_.shading)) *
           phong_sample(phong_exponent(bsdf_.alpha), u);
  }
  const Vec3 view = to_local(frame_.to_eye, frame_.shading);
  const Vec3 half = ggx_sample_half({view.x, view.y, cos_v_}, bsdf_.alpha, u);
  const Vec3 half_world = sampling::frame_from_normal(frame_.shading) * half;
  return glm::normalize(2.0F * glm::dot(frame_.to_eye, half_world) * half_world - frame_.to_eye);
}

std::optional<BsdfSample> Reflector::sample(const Vec3& u) const {
  BsdfSample sample;
  sample.to_light = sample_direction(u);
  sample.pdf = pdf(sample.to_light);
  const Rgb value = evaluate(sample.to_light);
  if (!(sample.pdf > 0.0F) || !(value.x + value.y + value.z > 0.0F)) return std::nullopt;
  sample.weight = value / sample.pdf;
  return sample;
}

float Reflector::pdf(const Vec3& to_light) const {
  const float cosine = std::max(glm::dot(frame_.shading, to_light), 0.0F);
  const float diffuse = (1.0F - lobe_share_) * cosine / kPi;
  return lobe_share_ == 0.0F ? diffuse : diffuse + lobe_share_ * lobe_pdf(to_light);
}

float Reflector::lobe_pdf(const Vec3& to_light) const {
  if (bsdf_.lobe == LobeModel::Phong) {
    const float exponent = phong_exponent(bsdf_.alpha);
    const Vec3 mirror = mirrored(frame_.to_eye, frame_.shading);
    return phong_pdf(phong_power(mirror, to_light, exponent), exponent);
  }
  const Vec3 sum = frame_.to_eye + to_light;
  const float length = glm::length(sum);
  if (length == 0.0F) return 0.0F;
  const float cos_half = glm::dot(frame_.shading, sum) / length;
  return ggx_reflection_pdf(cos_v_, cos_half, bsdf_.alpha);
}

}  // namespace macula::shading
