// SceneFrame: a scene at one moment with everything kernels ask of it. Immutable, shared by all
// sessions and threads while frames use it. World space, meters. SceneTimeline makes them.
#pragma once

#include <memory>
#include <optional>

#include "server/kernels/field_rays.h"
#include "server/lights/environment_light.h"
#include "server/lights/light_list.h"
#include "server/lights/placed_lights.h"
#include "server/scene/animation.h"
#include "server/scene/plan.h"
#include "server/shading/material_table.h"
#include "server/shading/surface.h"
#include "server/visibility/visibility.h"
#include "shared/base/result.h"

namespace macula::kernels {

using scene::SceneTime;

class SceneFrame {
 public:
  /// One moment alone: builds the plan's structures on all cores. Errors: those of
  /// visibility::TriangleScene::create.
  static Result<std::shared_ptr<const SceneFrame>> create(std::shared_ptr<const scene::Scene> scene,
                                                          const scene::ScenePlan& plan,
                                                          SceneTime time = {});
  /// By the scene's own plan.
  static Result<std::shared_ptr<const SceneFrame>> create(std::shared_ptr<const scene::Scene> scene,
                                                          SceneTime time = {});

  const scene::Scene& scene() const { return *still_->scene; }
  /// What kernels may run: a step that is left out has no structure here.
  const scene::ScenePlan& plan() const { return still_->plan; }
  const visibility::TriangleScene& triangles() const { return *triangles_; }
  const shading::SurfaceTable& surfaces() const { return surfaces_; }

  /// What rays meet, whether the scene is made of triangles or of distances: as
  /// visibility::TriangleScene and FieldRays say.
  void intersect(const visibility::RayStream& rays, visibility::HitStream& hits,
                 visibility::Coherence coherence) const;
  void occluded(const visibility::RayStream& rays, visibility::OcclusionStream& result,
                visibility::Coherence coherence) const;
  std::optional<visibility::Hit> intersect(const visibility::Ray& ray) const;
  bool occluded(const visibility::Ray& ray) const;
  /// The surface where a ray has met it. `point`, on the ray, is read for distance fields only:
  /// triangles interpolate more exactly.
  shading::Surface surface(const visibility::Hit& hit, const DVec3& point) const;
  /// As SurfaceTable's; 0 in distance fields.
  float uv_per_meter(scene::Index instance, scene::Index triangle) const {
    return field_rays_ ? 0.0F : surfaces_.uv_per_meter(instance, triangle);
  }

  const shading::MaterialTable& materials() const { return still_->materials; }
  const lights::LightList& lights() const { return lights_; }
  /// Black where the plan leaves the environment out.
  const lights::EnvironmentLight& environment() const { return still_->environment; }
  /// What a ray sees that meets nothing: the environment, in a scene without one the ambient light.
  Rgb beyond(const Vec3& direction) const {
    return scene().environment ? environment().radiance(direction) : scene().settings.ambient;
  }
  /// The same lights with a tree over them; none where the plan leaves the tree out.
  const lights::PlacedLights& placed_lights() const { return placed_lights_; }
  /// Where everything is at this moment.
  const scene::ScenePose& pose() const { return pose_; }
  SceneTime time() const { return pose_.time; }

 private:
  friend class SceneTimeline;
  /// What no moment changes.
  struct Still {
    std::shared_ptr<const scene::Scene> scene;
    scene::ScenePlan plan;
    shading::MaterialTable materials;
    lights::EnvironmentLight environment;
  };
  SceneFrame(std::shared_ptr<const Still> still, scene::ScenePose pose,
             const shading::SurfaceTable& surfaces, const lights::LightList& lights)
      : still_(std::move(still)), pose_(std::move(pose)), surfaces_(surfaces), lights_(lights) {}

  std::shared_ptr<const Still> still_;
  scene::ScenePose pose_;
  std::shared_ptr<const visibility::TriangleScene> triangles_;
  std::shared_ptr<visibility::TriangleScene> own_triangles_;  ///< the same where they move
  std::unique_ptr<const FieldRays> field_rays_;               ///< none: no distance field
  shading::SurfaceTable surfaces_;
  lights::LightList lights_;
  lights::PlacedLights placed_lights_;
};

}  // namespace macula::kernels
