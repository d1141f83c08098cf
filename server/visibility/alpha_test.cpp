#include "server/visibility/alpha_test.h"

#include <cmath>

namespace macula::visibility {
namespace {

constexpr float kBlendCutoff = 0.5F;

float cutoff(const scene::Material& material) {
  return material.alpha_mode == scene::AlphaMode::Mask ? material.alpha_cutoff : kBlendCutoff;
}

/// KHR_texture_transform: scale, then a rotation that turns counter-clockwise as seen with v down.
Vec2 transformed(const scene::TextureRef& texture, const Vec2& uv) {
  const float c = std::cos(texture.uv_rotation_rad), s = std::sin(texture.uv_rotation_rad);
  const Vec2 scaled = texture.uv_scale * uv;
  return texture.uv_offset + Vec2{c * scaled.x + s * scaled.y, -s * scaled.x + c * scaled.y};
}

/// Texel index of coordinate x in texture units, for `size` >= 1 texels.
int wrapped_texel(float x, int size, scene::Wrap wrap) {
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
  const float texel = std::floor(unit * static_cast<float>(size));
  if (!(texel > 0.0F)) return 0;  // also NaN
  return texel < static_cast<float>(size - 1) ? static_cast<int>(texel) : size - 1;
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
  if (material.alpha < cutoff(material)) return AlphaUse::NeverThere;  // texels only lower alpha
  return textured ? AlphaUse::PerTexel : AlphaUse::AlwaysThere;
}

AlphaTest::AlphaTest(const scene::Scene& scene, const scene::Mesh& mesh)
    : triangles_(mesh.triangles) {
  if (alpha_use(scene, mesh) == AlphaUse::AlwaysThere) {
    texcoords_.assign(mesh.positions.size(), Vec2{0.0F});
    alpha_ = image::Plane<std::uint8_t>(1, 1, 255);
    return;
  }
  const scene::Material& material = scene.materials[mesh.material];
  const scene::TextureRef& texture = *material.base_color_texture;
  texcoords_.reserve(mesh.texcoords.size());
  for (const Vec2& uv : mesh.texcoords) texcoords_.push_back(transformed(texture, uv));
  alpha_ = alpha_channel(scene.images[texture.image].pixels);
  wrap_u_ = texture.wrap_u;
  wrap_v_ = texture.wrap_v;
  least_texel_ = 255.0F * cutoff(material) / material.alpha;
}

bool AlphaTest::is_there(std::uint32_t triangle, float u, float v) const {
  const UVec3& corners = triangles_[triangle];
  const Vec2 uv = (1.0F - u - v) * texcoords_[corners.x] + u * texcoords_[corners.y] +
                  v * texcoords_[corners.z];
  const int x = wrapped_texel(uv.x, alpha_.width(), wrap_u_);
  const int y = wrapped_texel(uv.y, alpha_.height(), wrap_v_);
  return static_cast<float>(alpha_(x, y)) >= least_texel_;
}

}  // namespace macula::visibility
