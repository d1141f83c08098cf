// SceneFrame: a scene at one moment with everything kernels ask of it. Immutable, shared by all
// sessions and threads while frames use it. World space, meters.
#pragma once

#include <memory>

#include "server/lights/environment_light.h"
#include "server/lights/light_list.h"
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
  /// Builds the plan's structures on all cores. Errors: those of visibility::TriangleScene::create.
  static Result<std::shared_ptr<const SceneFrame>> create(std::shared_ptr<const scene::Scene> scene,
                                                          const scene::ScenePlan& plan,
                                                          SceneTime time = {});
  /// By the scene's own plan.
  static Result<std::shared_ptr<const SceneFrame>> create(std::shared_ptr<const scene::Scene> scene,
                                                          SceneTime time = {});

  const scene::Scene& scene() const { return *scene_; }
  /// What kernels may run: a step that is left out has no structure here.
  const scene::ScenePlan& plan() const { return plan_; }
  const visibility::TriangleScene& triangles() const { return *triangles_; }
  const shading::SurfaceTable& surfaces() const { return surfaces_; }
  const shading::MaterialTable& materials() const { return materials_; }
  const lights::LightList& lights() const { return lights_; }
  /// Black where the plan leaves the environment out.
  const lights::EnvironmentLight& environment() const { return environment_; }
  /// What a ray sees that meets nothing: the environment, in a scene without one the ambient light.
  Rgb beyond(const Vec3& direction) const {
    return scene_->environment ? environment_.radiance(direction) : scene_->settings.ambient;
  }
  /// Where everything is at this moment; the scene's own tables know it before it moves.
  const scene::ScenePose& pose() const { return pose_; }
  SceneTime time() const { return pose_.time; }

 private:
  SceneFrame(std::shared_ptr<const scene::Scene> scene, const scene::ScenePlan& plan,
             scene::ScenePose pose, std::shared_ptr<const visibility::TriangleScene> triangles);

  std::shared_ptr<const scene::Scene> scene_;
  scene::ScenePlan plan_;
  scene::ScenePose pose_;
  std::shared_ptr<const visibility::TriangleScene> triangles_;
  shading::SurfaceTable surfaces_;
  shading::MaterialTable materials_;
  lights::LightList lights_;
  lights::EnvironmentLight environment_;
};

}  // namespace macula::kernels
