#include "tests/bench/ray_setting.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "server/kernels/registry.h"
#include "shared/base/text.h"
#include "tests/bench/lit_scene.h"

namespace macula::bench {
namespace {

/// Tangents of the DK2's left eye as its SDK gives them.
Fov dk2_fov() {
  return {Radians{-std::atan(1.058)}, Radians{std::atan(1.092)}, Radians{std::atan(1.329)},
          Radians{-std::atan(1.329)}};
}

/// A square of 1 m that shines downwards.
void add_lamp(scene::Scene& scene, const Vec3& centre) {
  scene::Material shining;
  shining.base_color = Rgb{0.0F};
  shining.specular = 0.0F;
  shining.emission = Rgb{10.0F};
  scene.materials.push_back(shining);
  scene::Mesh mesh;
  const float h = 0.5F;
  mesh.positions = {centre + Vec3{-h, 0, -h}, centre + Vec3{h, 0, -h}, centre + Vec3{h, 0, h},
                    centre + Vec3{-h, 0, h}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = static_cast<scene::Index>(scene.materials.size() - 1);
  scene.instances.push_back({static_cast<scene::Index>(scene.meshes.size()), DMat4{1.0}});
  scene.meshes.push_back(mesh);
}

void light_up(scene::Scene& scene, PaperLighting lighting, const Vec3& lamp) {
  switch (lighting) {
    case PaperLighting::Point: {
      scene::Light light;
      light.intensity = Rgb{10.0F};
      light.position = DVec3(lamp);
      scene.lights = {light};
      break;
    }
    case PaperLighting::Area8:
      add_lamp(scene, lamp);
      break;
    case PaperLighting::Ao16: {
      scene.settings.ambient = Rgb{1.0F};
      constexpr double kReach = 0.1;  // of the scene's diagonal: an interior is not all black
      scene.settings.ambient_distance_m =
          std::min(scene.settings.ambient_distance_m, kReach * glm::length(scene.bounds().size()));
      break;
    }
  }
}

/// Exposure that brings the mean luminance of a small first picture to middle grey.
float exposure_of(const RaySetting& setting) {
  constexpr int kSide = 64;
  kernels::KernelOptions options;
  options.samples_per_cell = 4;
  const auto kernel = kernels::make_kernel("ray", options);
  const foveation::Display small{setting.display.fov, kSide, kSide};
  const kernels::View view{setting.start, foveation::make_uniform_grid(small), {}, {}};
  const FoveationMap map({{view.grid, view.gaze, small.pixel_tangent()}}, foveation::RateModel{});
  kernels::History history;
  kernels::FrameBuffers out;
  scheduling::TileScheduler scheduler;
  (*kernel)->render({{&view, 1}, map, 0, 1}, *setting.scene, history, scheduler, out);
  return exposure_for(out.views.front().radiance);
}

}  // namespace

Result<PaperLighting> find_lighting(const std::string& name) {
  if (name == "point") return PaperLighting::Point;
  if (name == "area8") return PaperLighting::Area8;
  if (name == "ao16") return PaperLighting::Ao16;
  return base::bad_input("unknown lighting '" + name + "'", "--lighting",
                         "allowed: point, area8, ao16");
}

Pose swayed(const Pose& start, double seconds) {
  const auto wave = [seconds](double period_s, double amplitude) {
    return amplitude * std::sin(2.0 * std::numbers::pi * seconds / period_s);
  };
  const DQuat yaw = glm::angleAxis(Radians{Degrees{wave(4.3, 12.0)}}.value(), DVec3{0, 1, 0});
  const DQuat pitch = glm::angleAxis(Radians{Degrees{wave(3.1, 5.0)}}.value(), DVec3{1, 0, 0});
  const DVec3 sway{wave(2.7, 0.12), wave(1.3, 0.02), wave(5.9, 0.25)};
  return {start.position + start.rotation * sway, start.rotation * yaw * pitch};
}

Pose RaySetting::pose_at(double seconds) const {
  return swayed(start, seconds);
}

Result<RaySetting> RaySetting::make(std::shared_ptr<const scene::Scene> scene,
                                    PaperLighting lighting, shading::MaterialModel materials,
                                    int width_px, int height_px) {
  RaySetting setting;
  setting.lighting = lighting;
  setting.materials = materials;
  setting.display = {dk2_fov(), width_px, height_px};
  setting.start = starting_pose(*scene);
  const auto unlit = kernels::SceneFrame::create(scene);
  if (!unlit) return base::forward(unlit);
  setting.light = lamp_place(**unlit, setting.start);
  auto lit = std::make_shared<scene::Scene>(*scene);
  switch_off(*lit);
  light_up(*lit, lighting, setting.light);
  auto frame = kernels::SceneFrame::create(std::move(lit));
  if (!frame) return base::forward(frame);
  setting.scene = std::move(*frame);
  setting.tone.exposure_ev = exposure_of(setting);
  return setting;
}

}  // namespace macula::bench
