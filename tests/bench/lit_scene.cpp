#include "tests/bench/lit_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/scene/animation.h"

namespace macula::bench {

constexpr double kStandingEye_m = 1.6;

Pose starting_pose(const scene::Scene& scene) {
  if (!scene.cameras.empty())
    return scene::pose_at(scene, scene::SceneTime{}).world_from_view.front();
  return scene.settings.scene_from_stage *
         Pose{DVec3{0.0, kStandingEye_m, 0.0}, DQuat{1.0, 0.0, 0.0, 0.0}};
}

Vec3 lamp_place(const kernels::SceneFrame& scene, const Pose& eye) {
  const Vec3 from(eye.position);
  const auto above = scene.triangles().intersect(
      visibility::Ray{from, Vec3{0.0F, 1.0F, 0.0F}, 0.0F, std::numeric_limits<float>::infinity()});
  const float height = above ? std::min(0.75F * above->t, 4.0F) : 4.0F;
  return from + Vec3{0.0F, height, 0.0F};
}

void switch_off(scene::Scene& scene) {
  scene.lights.clear();
  scene.environment.reset();
  scene.settings.ambient = Rgb{0.0F};
  for (scene::Material& material : scene.materials) {
    material.emission = Rgb{0.0F};
    material.emission_texture.reset();
  }
}

float exposure_for(const image::Plane<Rgb>& radiance) {
  double sum = 0.0;
  for (const Rgb& value : radiance.pixels()) sum += static_cast<double>(image::luminance(value));
  const double mean = sum / static_cast<double>(radiance.size());
  return mean > 0.0 ? static_cast<float>(std::log2(0.18 / mean)) : 0.0F;
}

}  // namespace macula::bench
