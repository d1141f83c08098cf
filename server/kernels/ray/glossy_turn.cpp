#include "server/kernels/ray/glossy_turn.h"

#include <cmath>

namespace macula::kernels::ray {
namespace {

/// Broader lobes change more slowly with the direction of view than memory is renewed: a rate of
/// .05 looks at every cell once in 34 frames, in which a head at 1 m/s walks .5 m.
constexpr float kBroadest = 0.36F;

}  // namespace

GlossyTurn::GlossyTurn(const SceneFrame& scene, const Config& config)
    : surfaces_(scene.surfaces()) {
  if (!scene.plan().has(scene::Step::SpecularLobe) || !scene.plan().has(scene::Step::TriangleBvh))
    return;
  std::vector<float> alpha(scene.materials().size(), 0.0F);
  bool any = false;
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    const auto material = static_cast<scene::Index>(i);
    const float width = scene.materials().lobe_width(material, config.materials);
    if (width > kBroadest) continue;
    alpha[i] = width;
    any = any || width > 0.0F;
  }
  if (any) alpha_ = std::move(alpha);
}

/// The sine is that between now and the way: nothing cancels where the eye hardly moved.
float GlossyTurn::turn(const View& view, const image::Pixel& cell, float depth_m,
                       std::uint32_t surface_id, const Vec3& way) const {
  if (surface_id == 0 || !std::isfinite(depth_m)) return 0.0F;
  const float alpha = alpha_[surfaces_.material(surface_id - 1)];
  if (alpha == 0.0F) return 0.0F;
  // Over the depth, so that no square of a far point's is infinite.
  const Vec3 ray = view.grid.ray(cell.x, cell.y), across = way * inverse_of(depth_m);
  const float sine = glm::length(glm::cross(ray, across));
  return std::atan2(sine, glm::dot(ray, ray + across)) / alpha;
}

}  // namespace macula::kernels::ray
