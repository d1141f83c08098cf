#include "tests/bench/culling_setting.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "server/kernels/registry.h"
#include "server/scene/built_in/shapes.h"
#include "server/scene/load.h"
#include "tests/bench/lit_scene.h"

namespace macula::bench {
namespace {

constexpr Degrees kFov{90.0};
constexpr double kFoveaShare = 150.0 / 512.0;  ///< of half the picture
constexpr double kTurn = 2.0 * std::numbers::pi;

/// A circle about `centre` in four seconds, level.
scene::Joint circling(const DVec3& centre, double radius_m) {
  constexpr int kKeys = 32;
  constexpr double kPeriod_s = 4.0;
  scene::Joint joint;
  joint.period = units::from_s(kPeriod_s);
  for (int key = 0; key <= kKeys; ++key) {
    const double angle = kTurn * key / kKeys;
    joint.translations.times_s.push_back(kPeriod_s * key / kKeys);
    joint.translations.values.push_back(centre +
                                        radius_m * DVec3{std::cos(angle), 0.0, std::sin(angle)});
  }
  return joint;
}

void hang_lamp(scene::Scene& scene, const DVec3& place, bool moves) {
  constexpr double kCircle_m = 0.5;
  scene::Light light;
  light.intensity = Rgb{10.0F};
  light.position = place + DVec3{kCircle_m, 0.0, 0.0};
  if (moves) {
    scene.joints.push_back(circling(place, kCircle_m));
    light.position = DVec3{0.0};
    light.joint = static_cast<scene::Index>(scene.joints.size() - 1);
  }
  scene.lights = {light};
}

/// Ahead of the eye and a little below, so that it passes through the fovea.
void add_ball(scene::Scene& scene, const Pose& eye, bool moves) {
  constexpr double kCircle_m = 0.6;
  constexpr float kRadius_m = 0.3F;
  const DVec3 centre = eye.position + eye.rotation * DVec3{0.0, -0.3, -3.0};
  scene::Material red;
  red.name = "ball";
  red.base_color = Rgb{0.75F, 0.10F, 0.08F};
  red.specular = 0.0F;
  scene.materials.push_back(red);
  scene::Mesh ball = scene::built_in::sphere("ball", kRadius_m, 48, 24);
  ball.material = static_cast<scene::Index>(scene.materials.size() - 1);
  scene::Instance instance;
  instance.mesh = static_cast<scene::Index>(scene.meshes.size());
  if (moves) {
    scene.joints.push_back(circling(centre, kCircle_m));
    instance.joint = static_cast<scene::Index>(scene.joints.size() - 1);
  } else {
    instance.parent_from_object = glm::translate(DMat4{1.0}, centre + DVec3{kCircle_m, 0.0, 0.0});
  }
  scene.meshes.push_back(std::move(ball));
  scene.instances.push_back(instance);
}

std::shared_ptr<const FoveationMap> map_of(const kernels::View& view,
                                           const foveation::Display& display) {
  return std::make_shared<const FoveationMap>(
      std::vector<FoveationMap::ViewInput>{{view.grid, view.gaze, display.pixel_tangent()}},
      foveation::RateModel{});
}

/// Cells four pixels wide about the middles of pixels 2, 6, 10...
std::vector<float> thinned_edges(const std::vector<float>& edges) {
  constexpr auto kStep = static_cast<std::size_t>(CullingSetting::kThinning);
  std::vector<float> thinned;
  for (std::size_t i = 0; i + 1 < edges.size(); i += kStep)
    thinned.push_back(0.5F * (edges[i] + edges[i + 1]));
  thinned.push_back(thinned.back() + thinned[1] - thinned[0]);
  return thinned;
}

}  // namespace

Result<SceneMotion> find_motion(const std::string& name) {
  if (name == "static") return SceneMotion::Still;
  if (name == "light") return SceneMotion::Light;
  if (name == "object") return SceneMotion::Object;
  if (name == "both") return SceneMotion::Both;
  return base::bad_input("unknown motion '" + name + "'", "--motions",
                         "allowed: static, light, object, both");
}

Degrees CullingSetting::fovea() {
  return Degrees{Radians{std::atan(kFoveaShare * std::tan(0.5 * Radians{kFov}.value()))}};
}

Result<CullingSetting> CullingSetting::create(const std::string& name, SceneMotion motion,
                                              int side_px) {
  const auto loaded = scene::load_scene(name);
  if (!loaded) return base::forward(loaded);
  if (auto ok = kernels::check_scene("culling", **loaded); !ok) return base::forward(ok);
  const auto as_is = kernels::SceneFrame::create(*loaded);
  if (!as_is) return base::forward(as_is);
  CullingSetting setting;
  setting.eye_.view.world_from_view = starting_pose(**loaded);
  const Vec3 lamp = lamp_place(**as_is, setting.eye_.view.world_from_view);
  auto lit = std::make_shared<scene::Scene>(**loaded);
  switch_off(*lit);
  hang_lamp(*lit, DVec3(lamp), motion == SceneMotion::Light || motion == SceneMotion::Both);
  add_ball(*lit, setting.eye_.view.world_from_view,
           motion == SceneMotion::Object || motion == SceneMotion::Both);
  const scene::ScenePlan plan(scene::facts_of(*lit), {.kernel = "culling"});
  auto timeline = kernels::SceneTimeline::create(std::move(lit), plan);
  if (!timeline) return base::forward(timeline);
  setting.timeline_ = std::move(*timeline);
  setting.display_ = {math::symmetric_fov(kFov, 1.0), side_px, side_px};
  setting.eye_.view.grid = foveation::make_uniform_grid(setting.display_);
  setting.eye_.map = map_of(setting.eye_.view, setting.display_);
  return setting;
}

CullingSetting::Eye CullingSetting::thinned_eye() const {
  Eye eye = eye_;
  eye.view.grid.x_edges = thinned_edges(eye_.view.grid.x_edges);
  eye.view.grid.y_edges = thinned_edges(eye_.view.grid.y_edges);
  eye.map = map_of(eye.view, display_);
  return eye;
}

Result<std::shared_ptr<const kernels::SceneFrame>> CullingSetting::frame(int frame) const {
  return timeline_->at({units::from_s(frame / kRate_hz)});
}

std::vector<image::Pixel> sample_of_blocks(const foveation::Display& display) {
  constexpr int kBlock = 4, kStride = 32;
  std::vector<image::Pixel> pixels;
  for (int top = kStride / 2; top + kBlock <= display.height_px; top += kStride)
    for (int left = kStride / 2; left + kBlock <= display.width_px; left += kStride)
      for (int y = 0; y < kBlock; ++y)
        for (int x = 0; x < kBlock; ++x) pixels.push_back({left + x, top + y});
  return pixels;
}

}  // namespace macula::bench
