#include "server/kernels/scene_frame.h"

#include <utility>

#include "server/kernels/scene_timeline.h"
#include "shared/base/check.h"

namespace macula::kernels {

Result<std::shared_ptr<const SceneFrame>> SceneFrame::create(
    std::shared_ptr<const scene::Scene> scene, const scene::ScenePlan& plan, SceneTime time) {
  const auto timeline = SceneTimeline::create(std::move(scene), plan);
  if (!timeline) return base::forward(timeline);
  return (*timeline)->at(time);
}

Result<std::shared_ptr<const SceneFrame>> SceneFrame::create(
    std::shared_ptr<const scene::Scene> scene, SceneTime time) {
  MACULA_CHECK(scene != nullptr);
  const scene::ScenePlan plan(scene::facts_of(*scene));
  return create(std::move(scene), plan, time);
}

void SceneFrame::intersect(const visibility::RayStream& rays, visibility::HitStream& hits,
                           visibility::Coherence coherence) const {
  if (field_rays_) return field_rays_->intersect(rays, hits);
  triangles_->intersect(rays, hits, coherence);
}

void SceneFrame::occluded(const visibility::RayStream& rays, visibility::OcclusionStream& result,
                          visibility::Coherence coherence) const {
  if (field_rays_) return field_rays_->occluded(rays, result);
  triangles_->occluded(rays, result, coherence);
}

std::optional<visibility::Hit> SceneFrame::intersect(const visibility::Ray& ray) const {
  return field_rays_ ? field_rays_->intersect(ray) : triangles_->intersect(ray);
}

bool SceneFrame::occluded(const visibility::Ray& ray) const {
  return field_rays_ ? field_rays_->occluded(ray) : triangles_->occluded(ray);
}

shading::Surface SceneFrame::surface(const visibility::Hit& hit, const DVec3& point) const {
  if (!field_rays_) return surfaces_.at(hit.instance, hit.triangle, {hit.u, hit.v});
  shading::Surface surface;
  surface.position = point;
  surface.geometric_normal = surface.shading_normal = hit.normal;
  surface.material = hit.instance;
  surface.span_m = visibility::span_of_gap(hit.gap);
  return surface;
}

}  // namespace macula::kernels
