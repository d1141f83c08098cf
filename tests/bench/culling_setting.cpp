#include "tests/bench/culling_setting.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "server/kernels/registry.h"
#include "server/scene/built_in/shapes.h"
#include "server/scene/load.h"
#include "shared/foveation/eccentricity.h"
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
  setting.view_.world_from_view = starting_pose(**loaded);
  const Vec3 lamp = lamp_place(**as_is, setting.view_.world_from_view);
  auto lit = std::make_shared<scene::Scene>(**loaded);
  switch_off(*lit);
  hang_lamp(*lit, DVec3(lamp), motion == SceneMotion::Light || motion == SceneMotion::Both);
  add_ball(*lit, setting.view_.world_from_view,
           motion == SceneMotion::Object || motion == SceneMotion::Both);
  const scene::ScenePlan plan(scene::facts_of(*lit), {.kernel = "culling"});
  auto timeline = kernels::SceneTimeline::create(std::move(lit), plan);
  if (!timeline) return base::forward(timeline);
  setting.timeline_ = std::move(*timeline);
  setting.display_ = {math::symmetric_fov(kFov, 1.0), side_px, side_px};
  setting.view_.grid = foveation::make_uniform_grid(setting.display_);
  setting.map_ = std::make_shared<const FoveationMap>(
      std::vector<FoveationMap::ViewInput>{
          {setting.view_.grid, setting.view_.gaze, setting.display_.pixel_tangent()}},
      foveation::RateModel{});
  return setting;
}

Result<std::shared_ptr<const kernels::SceneFrame>> CullingSetting::frame(int frame) const {
  return timeline_->at({units::from_s(frame / kRate_hz)});
}

namespace {

/// Passes of one sample through the middle of each pixel: light alone is left to chance.
Plane<Rgb> mean_of_paths(const CullingSetting& setting, const kernels::SceneFrame& scene,
                         int samples, std::uint64_t seed, scheduling::TileScheduler& scheduler) {
  kernels::KernelOptions options;
  options.mode = kernels::Mode::Exact;
  options.jitter = false;
  options.ambient_samples = 0;
  options.lambert_only = true;
  options.bounces = 1;
  const auto kernel = kernels::make_kernel("brute", options);
  Plane<Rgb> mean(setting.display().width_px, setting.display().height_px);
  kernels::FrameBuffers out;
  kernels::History history;
  for (int pass = 0; pass < samples; ++pass) {
    const kernels::FrameRequest request{
        {&setting.view(), 1}, setting.map(), static_cast<std::uint64_t>(pass), seed};
    (*kernel)->render(request, scene, history, scheduler, out);
    const auto from = out.views.front().radiance.pixels();
    for (std::size_t i = 0; i < mean.size(); ++i)
      mean.pixels()[i] += from[i] / static_cast<float>(samples);
  }
  return mean;
}

}  // namespace

Result<HalfReferences> path_references(const CullingSetting& setting, const std::string& name,
                                       int frame, int samples, const PictureCache& cache,
                                       scheduling::TileScheduler& scheduler) {
  const auto scene = setting.frame(frame);
  if (!scene) return base::forward(scene);
  const auto half = [&](std::uint64_t seed) {
    Hasher hash;
    hash.add(hash_of(setting.scene())), hash.add(seed), hash.add(frame), hash.add(samples);
    hash.add(setting.display().width_px);
    for (const char letter : name) hash.add(letter);
    return cache.at(hash.value(), setting.display().width_px, setting.display().height_px,
                    [&] { return mean_of_paths(setting, **scene, samples, seed, scheduler); });
  };
  return HalfReferences{half(0x5EED'0001U), half(0x5EED'0002U)};
}

CullingJudge::CullingJudge(const CullingSetting& setting, HalfReferences references)
    : setting_(setting), references_(std::move(references)) {}

bool CullingJudge::inside(const image::Pixel& pixel) const {
  const auto& view = setting_.view();
  return foveation::eccentricity(view.gaze.direction, view.grid.ray(pixel.x, pixel.y)) <=
         Radians{CullingSetting::fovea()};
}

Rgb CullingJudge::shown(const Rgb& radiance) const {
  const float gain = std::exp2(setting_.view().tone.exposure_ev);
  return glm::clamp(gain * radiance, Rgb{0.0F}, Rgb{1.0F});
}

namespace {

std::vector<image::Pixel> all_pixels(const Plane<Rgb>& plane) {
  std::vector<image::Pixel> pixels;
  for (int y = 0; y < plane.height(); ++y)
    for (int x = 0; x < plane.width(); ++x) pixels.push_back({x, y});
  return pixels;
}

}  // namespace

FoveaErrors CullingJudge::errors(const Plane<Rgb>& radiance,
                                 std::span<const image::Pixel> pixels) const {
  if (pixels.empty()) return errors(radiance, all_pixels(radiance));
  FoveaErrors errors;
  for (const image::Pixel& at : pixels) {
    const Rgb value = shown(radiance(at.x, at.y));
    (inside(at) ? errors.inside : errors.outside)
        .add(value - shown(references_.first(at.x, at.y)),
             value - shown(references_.second(at.x, at.y)));
  }
  return errors;
}

FoveaErrors CullingJudge::difference(const Plane<Rgb>& a, const Plane<Rgb>& b,
                                     std::span<const image::Pixel> pixels) const {
  FoveaErrors errors;
  for (const image::Pixel& at : pixels) {
    const Rgb off = shown(a(at.x, at.y)) - shown(b(at.x, at.y));
    (inside(at) ? errors.inside : errors.outside).add(off, off);
  }
  return errors;
}

Plane<Rgb> CullingJudge::reference() const {
  Plane<Rgb> mean = references_.first;
  for (std::size_t i = 0; i < mean.size(); ++i)
    mean.pixels()[i] = 0.5F * (mean.pixels()[i] + references_.second.pixels()[i]);
  return mean;
}

std::vector<image::Pixel> sample_of_blocks(const foveation::Display& display) {
  constexpr int kBlock = 4, kStride = 16;
  std::vector<image::Pixel> pixels;
  for (int top = kStride / 2; top + kBlock <= display.height_px; top += kStride)
    for (int left = kStride / 2; left + kBlock <= display.width_px; left += kStride)
      for (int y = 0; y < kBlock; ++y)
        for (int x = 0; x < kBlock; ++x) pixels.push_back({left + x, top + y});
  return pixels;
}

double mean_luminance(const Plane<Rgb>& radiance, std::span<const image::Pixel> pixels) {
  if (pixels.empty()) return mean_luminance(radiance, all_pixels(radiance));
  double sum = 0.0;
  for (const image::Pixel& at : pixels)
    sum += static_cast<double>(image::luminance(radiance(at.x, at.y)));
  return sum / static_cast<double>(pixels.size());
}

}  // namespace macula::bench
