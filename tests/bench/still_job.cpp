#include "tests/bench/still_job.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "server/kernels/registry.h"
#include "server/scene/load.h"
#include "shared/base/text.h"
#include "tests/bench/progress.h"

namespace macula::bench {
namespace {

using base::bad_input;
using base::forward;

/// Samples a cell are taken in passes of at most this many, so that progress can be shown.
constexpr int kSamplesPerPass = 16;
/// Eye height of a standing viewer where a scene brings no camera.
constexpr double kStandingEye_m = 1.6;

/// CPU time of the whole process.
class Stopwatch {
 public:
  double lap_ms() {
    const std::clock_t now = std::clock(), begin = begin_;
    begin_ = now;
    return 1e3 * static_cast<double>(now - begin) / CLOCKS_PER_SEC;
  }

 private:
  std::clock_t begin_ = std::clock();
};

// ---- what is looked at ----

struct Shot {
  Pose world_from_view;
  Radians vertical_fov{Degrees{60.0}};
};

Result<Shot> explicit_shot(const StillCamera& camera, const scene::Settings& settings) {
  const DVec3 forward_axis = camera.target - camera.eye;
  if (!(glm::length(glm::cross(forward_axis, camera.up)) > 0.0)) {
    return bad_input("looks at its own place or along its up vector", "--camera",
                     "eye, target and up must span a plane");
  }
  const auto in_scene = [&](const DVec3& place) {
    return settings.meters_per_unit * place - settings.file_from_scene_m;
  };
  const Pose pose = math::look_at(in_scene(camera.eye), in_scene(camera.target), camera.up);
  if (!math::is_valid(pose)) return bad_input("is not finite or beyond 1e7 m", "--camera");
  return Shot{pose, camera.vertical_fov};
}

Shot camera_shot(const scene::Scene& scene, std::size_t camera, const scene::ScenePose& pose) {
  return {pose.world_from_view[camera], scene.cameras[camera].vertical_fov};
}

Result<Shot> named_shot(const scene::Scene& scene, const std::string& name,
                        const scene::ScenePose& pose) {
  std::string names;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    const scene::Camera& camera = scene.cameras[i];
    if (camera.name == name) return camera_shot(scene, i, pose);
    names += (names.empty() ? "" : ", ") + camera.name;
  }
  return bad_input(base::concat("the scene has no camera '", name, "'"), "--camera",
                   names.empty() ? "it has none; give one by eight numbers and a field of view"
                                 : "it has: " + names);
}

Result<Shot> choose_shot(const StillOptions& options, const scene::Scene& scene,
                         const scene::ScenePose& pose) {
  if (options.camera) return explicit_shot(*options.camera, scene.settings);
  if (!options.camera_name.empty()) return named_shot(scene, options.camera_name, pose);
  if (!scene.cameras.empty()) return camera_shot(scene, 0, pose);
  const Pose stage_from_view{DVec3{0.0, kStandingEye_m, 0.0}, DQuat{1.0, 0.0, 0.0, 0.0}};
  return Shot{scene.settings.scene_from_stage * stage_from_view};
}

Gaze gaze_of(const StillGaze& angles) {
  const double yaw = Radians{angles.yaw}.value(), pitch = Radians{angles.pitch}.value();
  return {Vec3(std::sin(yaw) * std::cos(pitch), std::sin(pitch), -std::cos(yaw) * std::cos(pitch))};
}

unsigned plane_flag(StillPlane plane) {
  switch (plane) {
    case StillPlane::Depth:
      return 0;  // always made
    case StillPlane::Normal:
      return kernels::kNormal;
    case StillPlane::Albedo:
      return kernels::kAlbedo;
    case StillPlane::Id:
      return kernels::kSurfaceId;
    case StillPlane::Rate:
      return kernels::kRate;
    case StillPlane::Samples:
      return kernels::kSamples;
    case StillPlane::Variance:
      return kernels::kVariance;
    case StillPlane::Steps:
      return kernels::kSteps;
  }
  return 0;
}

/// Adds one pass of `share` of all samples to the mean; other planes stay those of the first pass.
void merge(kernels::ViewBuffers& mean, const kernels::ViewBuffers& pass, float share) {
  for (std::size_t i = 0; i < mean.radiance.size(); ++i) {
    mean.radiance.pixels()[i] += share * pass.radiance.pixels()[i];
  }
  for (std::size_t i = 0; i < mean.variance.size(); ++i) {
    mean.variance.pixels()[i] += share * share * pass.variance.pixels()[i];
  }
  for (std::size_t i = 0; i < mean.samples.size(); ++i) {
    mean.samples.pixels()[i] += pass.samples.pixels()[i];
  }
}

kernels::ViewBuffers start_from(const kernels::ViewBuffers& pass, float share) {
  kernels::ViewBuffers mean = pass;
  for (Rgb& value : mean.radiance.pixels()) value *= share;
  for (float& value : mean.variance.pixels()) value *= share * share;
  return mean;
}

}  // namespace

std::string choose_kernel(const StillOptions& options, const scene::SceneFacts& facts) {
  if (options.kernel != "auto") return options.kernel;
  if (options.bounces.value_or(0) > 0) return "brute";
  std::vector<std::string_view> registered;
  for (const auto& entry : kernels::kernel_table()) registered.push_back(entry.name);
  return std::string(
      scene::choose_kernel(facts, scene::IndirectLight::NotWanted, registered).kernel);
}

Result<StillJob> prepare_still(const StillOptions& options) {
  const auto rate = foveation::find_rate_model(options.rate_model);
  if (!rate) return forward(rate);
  StillJob job;
  Stopwatch watch;
  const auto loaded = scene::load_scene(options.scene);
  if (!loaded) return forward(loaded);
  const scene::SceneTime time{units::from_s(options.time_s)};
  const auto shot = choose_shot(options, **loaded, scene::pose_at(**loaded, time));
  if (!shot) return forward(shot);
  job.load_cpu_ms = watch.lap_ms();
  const scene::SceneFacts facts = scene::facts_of(**loaded);
  job.kernel = choose_kernel(options, facts);
  if (auto ok = kernels::check_scene(job.kernel, **loaded); !ok) return forward(ok);
  if (job.kernel != "sphere" && std::ranges::count(options.planes, StillPlane::Steps) > 0) {
    return bad_input("'steps' is made by kernel sphere only", "--aov");
  }
  auto frame =
      kernels::SceneFrame::create(*loaded, scene::ScenePlan(facts, {.kernel = job.kernel}), time);
  if (!frame) return forward(frame);
  job.build_cpu_ms = watch.lap_ms();
  job.scene = *frame;
  job.display = {math::symmetric_fov(shot->vertical_fov,
                                     static_cast<double>(options.width_px) / options.height_px),
                 options.width_px, options.height_px};
  job.rate = *rate;
  job.view.world_from_view = shot->world_from_view;
  job.view.gaze = gaze_of(options.gaze);
  job.view.tone = (*loaded)->settings.tone;
  job.view.grid = options.grid == StillGrid::Uniform
                      ? foveation::make_uniform_grid(job.display)
                      : foveation::make_foveal_grid(job.display, job.view.gaze, *rate);
  for (const StillPlane plane : options.planes) job.wanted |= plane_flag(plane);
  return job;
}

Result<RenderedStill> render_still(const StillJob& job, const StillOptions& options) {
  kernels::KernelOptions settings;
  settings.mode = options.mode == StillMode::Fast ? kernels::Mode::Fast : kernels::Mode::Exact;
  settings.area_light_samples = options.light_samples;
  settings.ambient_samples = options.light_samples;
  if (options.perceived_lights) settings.light_share = kernels::LightShare::Perceived;
  settings.environment_samples = options.light_samples;
  settings.bounces = options.bounces;
  settings.lambert_only = options.material == StillMaterial::Lambert;

  const auto knobs = kernels::parse_knobs(options.knobs);
  if (!knobs) return forward(knobs);
  scheduling::TileScheduler scheduler(options.threads);
  const FoveationMap map({{job.view.grid, job.view.gaze, job.display.pixel_tangent()}}, job.rate);
  kernels::History history;
  kernels::FrameBuffers buffers;
  buffers.wanted = job.wanted;
  RenderedStill rendered;
  Progress progress("rendering", options.samples_per_cell);
  Stopwatch watch;
  for (int done = 0, pass = 0; done < options.samples_per_cell; ++pass) {
    settings.samples_per_cell = std::min(kSamplesPerPass, options.samples_per_cell - done);
    const auto kernel = kernels::make_kernel(job.kernel, settings, *knobs);
    if (!kernel) return forward(kernel);
    const kernels::FrameRequest request{
        {&job.view, 1}, map, static_cast<std::uint64_t>(pass), options.seed};
    const auto report = (*kernel)->render(request, *job.scene, history, scheduler, buffers);
    const float share = static_cast<float>(settings.samples_per_cell) /
                        static_cast<float>(options.samples_per_cell);
    if (pass == 0) {
      rendered.planes = start_from(buffers.views.front(), share);
    } else {
      merge(rendered.planes, buffers.views.front(), share);
    }
    rendered.report += report;
    done += settings.samples_per_cell;
    progress.advance(settings.samples_per_cell);
  }
  rendered.cpu_ms = watch.lap_ms();
  return rendered;
}

}  // namespace macula::bench
