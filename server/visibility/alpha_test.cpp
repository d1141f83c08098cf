#include "server/visibility/alpha_test.h"

#include <algorithm>
#include <cmath>

#include "shared/math/hash.h"

namespace macula::visibility {
namespace {

/// KHR_texture_transform: scale, then a rotation that turns counter-clockwise as seen with v down.
Vec2 transformed(const scene::TextureRef& texture, const Vec2& uv) {
  const float c = std::cos(texture.uv_rotation_rad), s = std::sin(texture.uv_rotation_rad);
  const Vec2 scaled = texture.uv_scale * uv;
  return texture.uv_offset + Vec2{c * scaled.x + s * scaled.y, -s * scaled.x + c * scaled.y};
}

/// Into [0, 1] texture units; 0 for a coordinate that is not finite.
float wrapped(float x, scene::Wrap wrap) {
  float unit = 0.0F;
  switch (wrap) {
    case scene::Wrap::Clamp:
      unit = x;
      break;
    case scene::Wrap::Repeat:
      unit = x - std::floor(x);
      break;
    case scene::Wrap::Mirror:
      unit = 1.0F - std::abs(x - 2.0F * std::floor(0.5F * x) - 1.0F);
      break;
  }
  return unit > 0.0F ? std::min(unit, 1.0F) : 0.0F;  // also NaN
}

/// The two texels around a coordinate, and how far the second is.
struct Between {
  int first, second;
  float share;
};
Between between_texels(float x, int size, scene::Wrap wrap) {
  const float at = wrapped(x, wrap) * static_cast<float>(size) - 0.5F;
  const int first = static_cast<int>(std::floor(at));
  const float share = at - static_cast<float>(first);
  const bool repeats = wrap == scene::Wrap::Repeat;
  return {first < 0 ? (repeats ? size - 1 : 0) : first,
          first + 1 < size ? first + 1 : (repeats ? 0 : size - 1), share};
}

/// Exact where both are the same.
float mix(float a, float b, float share) {
  return a + share * (b - a);
}

/// In (0, 1), 23 bits and a half: never 0, which nothing must reach, never 1, which all must.
float chance(BlendRule rule, std::uint32_t instance, std::uint32_t triangle) {
  const std::uint64_t surface = math::hash_combine(instance, triangle);
  const std::uint64_t bits = math::hash_combine(rule, surface) >> 41;
  return (static_cast<float>(bits) + 0.5F) * 0x1p-23F;
}

image::Plane<std::uint8_t> alpha_channel(const image::Plane<image::Rgba8>& pixels) {
  image::Plane<std::uint8_t> alpha(pixels.width(), pixels.height());
  for (std::size_t i = 0; i < pixels.size(); ++i) alpha.data()[i] = pixels.data()[i].a;
  return alpha;
}

}  // namespace

AlphaUse alpha_use(const scene::Scene& scene, const scene::Mesh& mesh) {
  const scene::Material& material = scene.materials[mesh.material];
  if (material.alpha_mode == scene::AlphaMode::Opaque) return AlphaUse::AlwaysThere;
  const bool textured = material.base_color_texture && !mesh.texcoords.empty() &&
                        !scene.images[material.base_color_texture->image].pixels.empty();
  // Texels only lower alpha.
  if (material.alpha_mode == scene::AlphaMode::Blend) {
    if (material.alpha <= 0.0F) return AlphaUse::NeverThere;
    return textured || material.alpha < 1.0F ? AlphaUse::PerPoint : AlphaUse::AlwaysThere;
  }
  if (material.alpha < material.alpha_cutoff) return AlphaUse::NeverThere;
  return textured ? AlphaUse::PerPoint : AlphaUse::AlwaysThere;
}

bool blends(const scene::Scene& scene, const scene::Mesh& mesh) {
  return scene.materials[mesh.material].alpha_mode == scene::AlphaMode::Blend &&
         alpha_use(scene, mesh) == AlphaUse::PerPoint;
}

AlphaTest::AlphaTest(const scene::Scene& scene, const scene::Mesh& mesh)
    : triangles_(mesh.triangles), blends_(visibility::blends(scene, mesh)) {
  const scene::Material& material = scene.materials[mesh.material];
  if (blends_) factor_ = material.alpha;
  if (alpha_use(scene, mesh) == AlphaUse::AlwaysThere || !material.base_color_texture ||
      mesh.texcoords.empty()) {
    texcoords_.assign(mesh.positions.size(), Vec2{0.0F});
    return;
  }
  const scene::TextureRef& texture = *material.base_color_texture;
  texcoords_.reserve(mesh.texcoords.size());
  for (const Vec2& uv : mesh.texcoords) texcoords_.push_back(transformed(texture, uv));
  const image::Plane<image::Rgba8>& pixels = scene.images[texture.image].pixels;
  if (!pixels.empty()) alpha_ = alpha_channel(pixels);
  wrap_u_ = texture.wrap_u;
  wrap_v_ = texture.wrap_v;
  if (!blends_) least_texel_ = 255.0F * material.alpha_cutoff / material.alpha;
}

float AlphaTest::texel(std::uint32_t triangle, float u, float v) const {
  const UVec3& corners = triangles_[triangle];
  const Vec2 uv = (1.0F - u - v) * texcoords_[corners.x] + u * texcoords_[corners.y] +
                  v * texcoords_[corners.z];
  const Between x = between_texels(uv.x, alpha_.width(), wrap_u_);
  const Between y = between_texels(uv.y, alpha_.height(), wrap_v_);
  const float upper = mix(alpha_(x.first, y.first), alpha_(x.second, y.first), x.share);
  const float lower = mix(alpha_(x.first, y.second), alpha_(x.second, y.second), x.share);
  return mix(upper, lower, y.share);
}

bool AlphaTest::is_there(std::uint32_t triangle, float u, float v) const {
  return texel(triangle, u, v) >= least_texel_;
}

bool AlphaTest::is_there(std::uint32_t triangle, float u, float v, BlendRule rule,
                         std::uint32_t instance) const {
  const float coverage = texel(triangle, u, v) / 255.0F * factor_;
  const bool by_chance = rule >> 31 != 0;
  return coverage >=
         (by_chance ? chance(rule, instance, triangle) : static_cast<float>(rule) * 0x1p-31F);
}

}  // namespace macula::visibility
