#include "tests/bench/lightcuts_setting.h"

#include <algorithm>
#include <cmath>

#include "server/kernels/lightcuts/lobe.h"
#include "server/kernels/lightcuts/surfaces.h"
#include "server/kernels/planes.h"
#include "server/kernels/registry.h"
#include "server/kernels/vpl/virtual_lights.h"
#include "server/scene/animation.h"
#include "server/scene/load.h"
#include "shared/image/regions.h"
#include "tests/bench/lit_scene.h"
#include "tests/bench/ray_setting.h"
#include "tests/bench/stopwatch.h"

namespace macula::bench {
namespace {

using kernels::lightcuts::Config;
using kernels::lightcuts::CutSizes;
using scheduling::TileScheduler;

constexpr double kTangent = 1.1;
constexpr int kWidth_px = 720, kHeight_px = 850;
constexpr std::uint64_t kFirstReferenceSeed = 1'000'000, kSecondReferenceSeed = 2'000'000;

foveation::Display paper_display(bool half) {
  const int divisor = half ? 2 : 1;
  const Radians across{std::atan(kTangent)}, up{std::atan(kTangent * kHeight_px / kWidth_px)};
  return {{-across, across, up, -up}, kWidth_px / divisor, kHeight_px / divisor};
}

Plane<Rgb> mean_picture(const LightcutsSetting& setting, int nodes, int passes, std::uint64_t seed,
                        TileScheduler& scheduler) {
  Plane<Rgb> mean(setting.display.width_px, setting.display.height_px);
  for (int pass = 0; pass < passes; ++pass) {
    const Picture one = picture_of(setting, uniform_cuts(nodes),
                                   seed + static_cast<std::uint64_t>(pass), scheduler);
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean.pixels()[i] += one.radiance.pixels()[i] / static_cast<float>(passes);
    }
  }
  return mean;
}

/// Kept for later runs. Virtual lights are the scene's and a number's.
Plane<Rgb> half_reference(const LightcutsSetting& setting,
                          const LightcutsJudge::References& references, std::uint64_t seed,
                          TileScheduler& scheduler) {
  Hasher hash;
  hash.add(hash_of(setting.scene->scene())), hash.add(setting.lights), hash.add(setting.gloss);
  hash.add(setting.view.world_from_view.position), hash.add(setting.view.world_from_view.rotation);
  hash.add(seed), hash.add(references.nodes), hash.add(references.passes);
  const int width = setting.display.width_px, height = setting.display.height_px;
  hash.add(width), hash.add(height);
  return references.cache.at(hash.value(), width, height, [&] {
    return mean_picture(setting, references.nodes, references.passes, seed, scheduler);
  });
}

/// A scene's name, the camera it is seen by (empty: the first), and whether its surfaces' light is
/// asked for as well.
struct Named {
  std::string scene, camera;
  bool bounced = false;
};
Named named(std::string name) {
  constexpr std::string_view kBounced = "-vpl";
  Named parts;
  parts.bounced = name.ends_with(kBounced);
  if (parts.bounced) name.resize(name.size() - kBounced.size());
  const std::size_t at = name.rfind('@');
  parts.scene = name.substr(0, at);
  if (at != std::string::npos) parts.camera = name.substr(at + 1);
  return parts;
}

Result<Pose> pose_of(const scene::Scene& scene, const std::string& camera) {
  if (camera.empty()) return starting_pose(scene);
  std::string names;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    if (scene.cameras[i].name == camera)
      return scene::pose_at(scene, scene::SceneTime{}).world_from_view[i];
    names += (names.empty() ? "" : ", ") + scene.cameras[i].name;
  }
  return base::bad_input("the scene has no camera '" + camera + "'", scene.name,
                         names.empty() ? "it has none: leave '@...' out" : names);
}

/// As many virtual lights as the paper's fifth scene has, but for rays that meet nothing.
kernels::BouncedLight bounced_light(TileScheduler& scheduler) {
  constexpr std::size_t kRays = 120'000;
  return [&scheduler](const kernels::SceneFrame& frame) {
    const kernels::vpl::Config config = kernels::vpl::shared_out(frame, kRays);
    return kernels::vpl::make_virtual_lights(frame, config, scheduler).lights;
  };
}

}  // namespace

Plane<float> as_floats(const Plane<std::uint16_t>& nodes) {
  Plane<float> plane(nodes.width(), nodes.height());
  std::ranges::copy(nodes.pixels(), plane.pixels().begin());
  return plane;
}

double mean_of(const Plane<float>& plane) {
  double sum = 0.0;
  for (const float value : plane.pixels()) sum += static_cast<double>(value);
  return sum / static_cast<double>(plane.size());
}

FoveationMap LightcutsSetting::map() const {
  return {{{view.grid, view.gaze, display.pixel_tangent()}}, {}};
}

Result<LightcutsSetting> LightcutsSetting::make(const std::string& name, bool half,
                                                kernels::lightcuts::Gloss gloss,
                                                TileScheduler& scheduler) {
  const auto [scene_name, camera, bounced] = named(name);
  const auto loaded = scene::load_scene(scene_name);
  if (!loaded) return base::forward(loaded);
  if (auto ok = kernels::check_scene("lightcuts", **loaded); !ok) return base::forward(ok);
  const scene::SceneFacts facts = scene::facts_of(**loaded);
  auto timeline =
      kernels::SceneTimeline::create(*loaded, scene::ScenePlan(facts, {.kernel = "lightcuts"}),
                                     bounced ? bounced_light(scheduler) : kernels::BouncedLight{});
  if (!timeline) return base::forward(timeline);
  auto frame = (*timeline)->at({});
  if (!frame) return base::forward(frame);
  if ((*frame)->placed_lights().size() == 0) {
    return base::bad_input("the scene has no light with a place", name,
                           "scenes with point lights, spots or emissive triangles");
  }
  const Result<Pose> pose = pose_of(**loaded, camera);
  if (!pose) return base::forward(pose);
  LightcutsSetting setting;
  setting.gloss = gloss;
  setting.timeline = std::move(*timeline);
  setting.scene = std::move(*frame);
  setting.display = paper_display(half);
  setting.view.grid = foveation::make_uniform_grid(setting.display);
  setting.view.world_from_view = *pose;
  setting.lights = setting.scene->placed_lights().size();
  constexpr int kExposureNodes = 8;
  setting.view.tone.exposure_ev =
      exposure_for(picture_of(setting, uniform_cuts(kExposureNodes), 1, scheduler).radiance);
  return setting;
}

Result<LightcutsSetting> LightcutsSetting::moved(int frame) const {
  constexpr double kRefresh_hz = 72.0;
  const int phase = frame % kSwing;
  const double seconds = std::min(phase, kSwing - phase) / kRefresh_hz;
  LightcutsSetting then = *this;
  then.view.world_from_view = swayed(view.world_from_view, seconds);
  if (timeline->moves()) {
    auto moment = timeline->at(scene::SceneTime{units::from_s(seconds)});
    if (!moment) return base::forward(moment);
    then.scene = std::move(*moment);
  }
  return then;
}

void LightcutsSetting::look(Degrees right) {
  view.gaze.direction =
      Vec3(std::sin(Radians{right}.value()), 0.0, -std::cos(Radians{right}.value()));
}

Plane<std::uint8_t> glossy_pixels(const LightcutsSetting& setting, TileScheduler& scheduler) {
  const FoveationMap map = setting.map();
  kernels::FrameBuffers out;
  kernels::prepare_buffers({&setting.view, 1}, out);
  std::vector<kernels::lightcuts::ViewSurfaces> surfaces;
  kernels::lightcuts::trace_surfaces({{&setting.view, 1}, map, 0, 1}, *setting.scene,
                                     uniform_cuts(1).ray, scheduler, surfaces, out);
  Plane<std::uint8_t> glossy(setting.display.width_px, setting.display.height_px);
  for (const kernels::lightcuts::SurfaceTile& tile : surfaces.front().tiles) {
    for (std::size_t i = 0; i < tile.points.count; ++i) {
      const image::Pixel at = tile.pixel(i);
      glossy(at.x, at.y) = kernels::lightcuts::is_glossy(tile.points.reflectors.alpha.at[i]);
    }
  }
  return glossy;
}

Config uniform_cuts(int nodes) {
  kernels::KernelOptions options;
  options.jitter = false;
  options.area_light_samples = nodes;
  options.ambient_samples = 0;
  Config config = kernels::lightcuts::make_config(options);
  config.denoise = kernels::lightcuts::Denoise::No;
  return config;
}

Config denoised_cuts(int nodes) {
  Config config = uniform_cuts(nodes);
  config.denoise = kernels::lightcuts::Denoise::Yes;
  return config;
}

Config perceived_cuts(kernels::lightcuts::PerceptionMode mode) {
  Config config = uniform_cuts(1);
  config.sizes = CutSizes::Perceived;
  config.perception.mode = mode;
  config.source = kernels::lightcuts::LightSource::Walks;
  return config;
}

Config paper_cuts() {
  Config config = perceived_cuts(kernels::lightcuts::PerceptionMode::Attenuation);
  config.source = kernels::lightcuts::LightSource::LowResolution;
  return config;
}

Config reservoir_cuts(kernels::lightcuts::Denoise denoise) {
  Config config = paper_cuts();
  config.source = kernels::lightcuts::LightSource::Reservoirs;
  config.denoise = denoise;
  const bool exact = denoise == kernels::lightcuts::Denoise::No;
  config.reservoirs.traces_neighbours = exact;
  config.reservoirs.blends_colours = !exact;
  return config;
}

Picture picture_of(const LightcutsSetting& setting, const Config& config, std::uint64_t seed,
                   TileScheduler& scheduler) {
  kernels::History history;
  return picture_of(setting, config, seed, history, scheduler);
}

Picture picture_of(const LightcutsSetting& setting, const Config& config, std::uint64_t seed,
                   kernels::History& history, TileScheduler& scheduler) {
  const FoveationMap map = setting.map();
  kernels::FrameBuffers out;
  Config with_gloss = config;
  with_gloss.gloss = setting.gloss;
  const kernels::lightcuts::LightcutsKernel kernel(with_gloss);
  Stopwatch watch;
  Picture picture;
  picture.report =
      kernel.render({{&setting.view, 1}, map, 0, seed}, *setting.scene, history, scheduler, out);
  const Lap lap = watch.lap();
  picture.cpu_ms = lap.cpu_ms, picture.wall_ms = lap.wall_ms;
  picture.radiance = std::move(out.views.front().radiance);
  return picture;
}

kernels::lightcuts::LightPlan plan_of(const LightcutsSetting& setting, const Config& config,
                                      TileScheduler& scheduler) {
  const FoveationMap map = setting.map();
  return kernels::lightcuts::plan_lights({{&setting.view, 1}, map, 0, 1}, *setting.scene, config,
                                         scheduler);
}

LightcutsJudge::References references_of(const LightcutsOptions& options) {
  return {options.reference_nodes, options.reference_passes, PictureCache(options.references)};
}

LightcutsJudge::LightcutsJudge(const LightcutsSetting& setting, const References& references,
                               TileScheduler& scheduler)
    : tone_(setting.view.tone),
      first_(half_reference(setting, references, kFirstReferenceSeed, scheduler)),
      second_(half_reference(setting, references, kSecondReferenceSeed, scheduler)),
      glossy_(glossy_pixels(setting, scheduler)),
      eccentricity_(setting.display.width_px, setting.display.height_px) {
  look(setting);
}

void LightcutsJudge::look(const LightcutsSetting& setting) {
  const FoveationMap map = setting.map();
  for (int y = 0; y < eccentricity_.height(); ++y) {
    map.eccentricity_row(0, y, eccentricity_.row(y));
  }
}

template <class Value, class Counts>
Regional LightcutsJudge::regional(const Value& value_at, const Counts& counts) const {
  const auto mean = [&](image::Region region) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < eccentricity_.size(); ++i) {
      if (!image::contains(region, Radians{static_cast<double>(eccentricity_.pixels()[i])}))
        continue;
      if (counts(i)) sum += value_at(i), ++count;
    }
    return sum / static_cast<double>(count);
  };
  using image::Region;
  return {mean(Region::F25), mean(Region::Out25), mean(Region::F10)};
}

LightcutsErrors LightcutsJudge::errors(const Plane<Rgb>& radiance) const {
  const auto product = [](const Rgb& x, const Rgb& a, const Rgb& b) {
    return static_cast<double>(glm::dot(x - a, x - b)) / 3.0;
  };
  const auto shown = [&](const Plane<Rgb>& plane, std::size_t i) {
    return image::display_linear(tone_, plane.pixels()[i]);
  };
  LightcutsErrors errors;
  const auto mse = [&](std::size_t i) {
    return product(shown(radiance, i), shown(first_, i), shown(second_, i));
  };
  errors.mse = regional(mse);
  errors.diffuse = regional(mse, [&](std::size_t i) { return glossy_.pixels()[i] == 0; });
  errors.glossy = regional(mse, [&](std::size_t i) { return glossy_.pixels()[i] != 0; });
  const float gain = std::exp2(tone_.exposure_ev);
  errors.relmse = regional([&](std::size_t i) {
    const Rgb a = gain * first_.pixels()[i], b = gain * second_.pixels()[i];
    const double level = static_cast<double>(image::luminance(0.5F * (a + b)));
    return product(gain * radiance.pixels()[i], a, b) / (level * level + 1e-2);
  });
  return errors;
}

Plane<float> LightcutsJudge::error_map(const Plane<Rgb>& radiance) const {
  const Plane<Rgb> truth = reference();
  Plane<float> squares(radiance.width(), radiance.height());
  for (std::size_t i = 0; i < squares.size(); ++i) {
    const Rgb off = image::display_linear(tone_, radiance.pixels()[i]) -
                    image::display_linear(tone_, truth.pixels()[i]);
    squares.pixels()[i] = glm::dot(off, off) / 3.0F;
  }
  return squares;
}

Plane<float> LightcutsJudge::noise_map() const {
  Plane<float> squares(first_.width(), first_.height());
  for (std::size_t i = 0; i < squares.size(); ++i) {
    const Rgb apart = image::display_linear(tone_, first_.pixels()[i]) -
                      image::display_linear(tone_, second_.pixels()[i]);
    squares.pixels()[i] = glm::dot(apart, apart) / 12.0F;  // of two halves' mean: a quarter
  }
  return squares;
}

Plane<std::uint8_t> LightcutsJudge::within_f25() const {
  Plane<std::uint8_t> inside(eccentricity_.width(), eccentricity_.height());
  std::ranges::transform(eccentricity_.pixels(), inside.pixels().begin(), [](float e) {
    return image::contains(image::Region::F25, Radians{static_cast<double>(e)});
  });
  return inside;
}

Regional LightcutsJudge::mean(const Plane<float>& plane) const {
  return regional([&](std::size_t i) { return static_cast<double>(plane.pixels()[i]); });
}

double LightcutsJudge::share_of_f25() const {
  const auto inside = std::ranges::count(within_f25().pixels(), std::uint8_t{1});
  return static_cast<double>(inside) / static_cast<double>(eccentricity_.size());
}

Plane<Rgb> LightcutsJudge::reference() const {
  Plane<Rgb> mean = first_;
  for (std::size_t i = 0; i < mean.size(); ++i) {
    mean.pixels()[i] = 0.5F * (mean.pixels()[i] + second_.pixels()[i]);
  }
  return mean;
}

}  // namespace macula::bench
