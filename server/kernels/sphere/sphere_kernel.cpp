#include "server/kernels/sphere/sphere_kernel.h"

#include <algorithm>
#include <utility>

#include "server/kernels/planes.h"
#include "server/kernels/sphere/passes.h"
#include "server/sampling/blue_noise.h"
#include "shared/base/check.h"

namespace macula::kernels::sphere {
namespace {

SphereHistory& history_of(History& history, std::size_t views) {
  auto& own = record_of<SphereHistory>(history);
  if (own.views.size() != views) own.views.assign(views, ViewHistory{});
  return own;
}

bool keeps_history(const Config& config) {
  return config.foveation == Foveation::On && config.refresh != Refresh::EveryFrame;
}

void add_lighting_shortcuts(const LightingConfig& lighting, const Rgb& sky,
                            std::vector<std::string>& names) {
  if (lighting.shadows == Shadows::None) names.emplace_back("lights are not occluded");
  if (lighting.shadows == Shadows::Soft)
    names.emplace_back("penumbrae follow the least ratio of distance to way");
  if (sky == Rgb{0.0F}) return;
  if (lighting.sky == SkyLight::All) names.emplace_back("the sky is not occluded");
  if (lighting.sky == SkyLight::Near)
    names.emplace_back("the sky is occluded by distances along the normal");
}

std::vector<std::string> shortcuts_of(const Config& config, const Rgb& sky) {
  std::vector<std::string> names;
  add_lighting_shortcuts(config.lighting, sky, names);
  if (config.mode == Mode::Fast)
    names.emplace_back("patterns are averaged over the cell before shading");
  if (config.foveation == Foveation::Off) return names;
  names.emplace_back("unimportant cells are drawn from a quarter of the samples");
  if (config.refresh != Refresh::EveryFrame) {
    names.emplace_back(config.kept == Kept::Reprojected
                           ? "unimportant cells are kept from earlier frames, reprojected"
                           : "unimportant cells are kept from earlier frames, in place");
  }
  if (config.transition == Transition::Gaussian) names.emplace_back("transitions are blurred");
  return names;
}

}  // namespace

Config make_config(const KernelOptions& options) {
  Config config;
  config.mode = options.mode;
  config.samples_per_cell = options.samples_per_cell;
  config.block_samples = block_samples_for(config.samples_per_cell);
  config.foveation = options.mode == Mode::Exact ? Foveation::Off : Foveation::On;
  if (options.mode == Mode::Exact) {
    config.lighting.shadows = Shadows::Hard;
    config.lighting.sky = options.ambient_samples > 0 ? SkyLight::Traced : SkyLight::None;
    config.lighting.sky_samples = std::max(options.ambient_samples, 1);
  }
  config.materials =
      options.lambert_only ? shading::MaterialModel::Lambert : shading::MaterialModel::AsInScene;
  return config;
}

SphereKernel::SphereKernel(const Config& config) : config_(config) {
  MACULA_CHECK(config.samples_per_cell >= 1 && config.samples_per_cell <= kMostSamples);
  MACULA_CHECK(config.block_samples >= 1 && config.block_samples <= kMostSamples);
  sampling::BlueNoise::get();  // made now, not in the first frame
}

FrameReport SphereKernel::render(const FrameRequest& request, const SceneFrame& scene,
                                 History& history, TileScheduler& scheduler,
                                 FrameBuffers& out) const {
  MACULA_CHECK(scene.scene().field != nullptr, "kernel sphere renders distance fields only");
  prepare_buffers(request.views, out);
  FrameReport report;
  for (std::size_t v = 0; v < request.views.size() && !report.stopped; ++v) {
    const ViewContext context(request.views[v], scene, config_, request, out.wanted);
    ViewHistory now;
    ViewHistory* last = nullptr;
    if (keeps_history(config_)) last = &history_of(history, request.views.size()).views[v];
    report += render_view(context, last, scheduler, out.views[v], now);
    if (last != nullptr) *last = std::move(now);
  }
  if (!report.stopped) {
    report.stopped = fill_rate(request, scheduler, out) == scheduling::Outcome::Stopped;
  }
  report.biased_shortcuts = shortcuts_of(config_, scene.scene().settings.ambient);
  return report;
}

void SphereKernel::shade(std::span<const SurfacePoint> points, const SceneFrame& scene,
                         TileScheduler& scheduler, std::span<Rgb> out) const {
  MACULA_CHECK(points.size() == out.size());
  constexpr std::size_t kBatch = sampling::kBatch;
  if (points.empty()) return;
  const DVec3 origin = points.front().position;
  const Lighting lighting(scene, config_, origin);
  const sdf::Program program = sdf::compile(*scene.scene().field, seconds_of(scene.time()), origin);
  scheduler.run((points.size() + kBatch - 1) / kBatch, [&](std::size_t batch) {
    const auto part =
        points.subspan(batch * kBatch, std::min(kBatch, points.size() - batch * kBatch));
    SurfaceBatch surfaces{};
    for (const SurfacePoint& point : part) {
      const std::size_t i = surfaces.count++;
      surfaces.position.set(i, Vec3(point.position - origin));
      surfaces.normal.set(i, point.geometric_normal);
      surfaces.to_eye.set(i, point.to_eye);
      surfaces.cell_m.at[i] = point.footprint_m;
      surfaces.footprint_m.at[i] = config_.mode == Mode::Exact ? 0.0F : point.footprint_m;
      surfaces.keys[i].value = point.key;
      surfaces.material[i] = point.instance;
    }
    Occlusion occlusion(program);
    LitBatch lit{};
    lighting.light(surfaces, occlusion, lit);
    blacken_non_finite(surfaces.count, lit.radiance);
    for (std::size_t i = 0; i < part.size(); ++i) out[batch * kBatch + i] = lit.radiance[i];
  });
}

}  // namespace macula::kernels::sphere
