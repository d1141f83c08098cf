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

float GlossyTurn::turn(const View& view, const image::Pixel& cell, float depth_m,
                       std::uint32_t surface_id, const DVec3& then) const {
  if (surface_id == 0 || !std::isfinite(depth_m)) return 0.0F;
  const float alpha = alpha_[surfaces_.material(surface_id - 1)];
  if (alpha == 0.0F) return 0.0F;
  const DVec3 from_now = view.world_from_view.rotation *
                         (DVec3(view.grid.ray(cell.x, cell.y)) * static_cast<double>(depth_m));
  const DVec3 from_then = from_now + (view.world_from_view.position - then);
  const double sine = glm::length(glm::cross(from_now, from_then));
  const double angle = std::atan2(sine, glm::dot(from_now, from_then));
  return static_cast<float>(angle) / alpha;
}

}  // namespace macula::kernels::ray
