#include "server/kernels/culling/culling_kernel.h"

#include <utility>

#include "server/kernels/culling/keep_lights.h"
#include "server/kernels/culling/light_cuts.h"
#include "server/kernels/culling/moved_objects.h"
#include "server/kernels/culling/stage_clock.h"
#include "server/kernels/culling/steady_picture.h"
#include "server/kernels/culling/texel_light.h"
#include "server/kernels/planes.h"
#include "server/kernels/ray/full.h"
#include "server/kernels/ray/ray_kernel.h"
#include "shared/base/text.h"

namespace macula::kernels::culling {
namespace {

/// What a frame's cells are lit with.
class LightSetup {
 public:
  LightSetup(const Config& config, const KeptLights& kept)
      : table_(kept.lights, kept.cut_nodes.empty() ? config.classes : 1,
               static_cast<float>(kept.least_m)),
        lit_(config.ray) {
    const bool exact = config.ray.mode == Mode::Exact;
    lit_.virtual_lights = {&table_, config.asked, nullptr, config.shadows,
                           exact ? config.near_light : ray::NearLight::Lost};
    if (kept.cut_nodes.empty() || kept.lights.empty()) return;
    tree_ = tree_over(kept.lights);
    lit_.virtual_lights.tree = &tree_;
    lit_.virtual_lights.asked = kept.most_nodes;
  }
  LightSetup(const LightSetup&) = delete;
  LightSetup& operator=(const LightSetup&) = delete;

  const ray::Config& lit() const { return lit_; }
  ray::Config lamps_alone() const {
    ray::Config lamps = lit_;
    lamps.virtual_lights = {};
    return lamps;
  }

 private:
  lights::VirtualLightTable table_;
  lights::LightTree tree_;
  ray::Config lit_;
};

/// Puts calmed light in the place of what chance made.
void replace_light(ViewBuffers& view, const Plane<Rgb>& light) {
  const auto radiance = view.radiance.pixels();
  for (std::size_t i = 0; i < radiance.size(); ++i) {
    radiance[i] += (light.pixels()[i] - view.light.pixels()[i]) * view.reflectance.pixels()[i];
  }
}

TexelMap texels_of(const View& view, const Config& config) {
  return config.space == Space::LogPolar
             ? TexelMap::log_polar(view.grid, view.gaze, config.shrink, config.rings)
             : TexelMap::thinned(view.grid, config.texel_step);
}

bool lights_in_cells(const Config& config) {
  return config.ray.mode == Mode::Exact || config.space == Space::Cells ||
         config.route == Route::Cuts;
}

/// What comes after a frame's cells have been lit, mode Fast.
class Calming {
 public:
  Calming(const FrameRequest& request, const SceneFrame& scene, const Config& config,
          const LightSetup& setup, TileScheduler& scheduler)
      : request_(request), scene_(scene), config_(config), setup_(setup), scheduler_(scheduler) {}

  FrameReport run(CullingHistory& memory, FrameBuffers& out) const {
    const bool remembers = memory.views.size() == request_.views.size();
    const std::vector<reconstruction::Movers> movers = movers_of(memory.objects, out);
    std::vector<ViewMemory> now(request_.views.size());
    FrameReport report;
    for (std::size_t v = 0; v < request_.views.size(); ++v) {
      const View& view = request_.views[v];
      LightOverFrames mean{own_light(v, out.views[v], report), {}};
      if (remembers && config_.newest < 1.0F) {
        mean = remembered(view, out.views[v], memory.views[v], movers[v], config_.newest,
                          scheduler_, mean.light);
      } else {
        mean.frames.resize(mean.light.width(), mean.light.height(), 1.0F);
      }
      replace_light(out.views[v], mean.light);
      now[v] = {view.world_from_view,  view.grid,
                out.views[v].depth_m,  out.views[v].normal,
                std::move(mean.light), std::move(mean.frames)};
    }
    memory.views = std::move(now);
    const bool steady = config_.picture_frames > 1 && !report.stopped;
    memory.pictures = steady ? join_pictures(memory.pictures, movers, out, report)
                             : std::vector<reconstruction::PictureMemory>{};
    if (has_moving_objects(scene_)) memory.objects = places_of_objects(scene_);
    return report;
  }

 private:
  /// By view.
  std::vector<reconstruction::Movers> movers_of(const scene::ScenePose& before,
                                                const FrameBuffers& out) const {
    std::vector<reconstruction::Movers> movers(out.views.size());
    if (!has_moving_objects(scene_)) return movers;
    for (std::size_t v = 0; v < movers.size(); ++v)
      movers[v] = movers_in(out.views[v], before, scene_);
    return movers;
  }
  /// Of this frame alone.
  Plane<Rgb> own_light(std::size_t v, const ViewBuffers& buffers, FrameReport& report) const {
    const View& view = request_.views[v];
    Plane<Rgb> light = config_.blur_reach > 0
                           ? shared_light(view, buffers, config_.blur_reach, scheduler_)
                           : buffers.light;
    if (!lights_in_cells(config_) && setup_.lit().virtual_lights.any()) {
      report += add_texel_light(request_, v, texels_of(view, config_), scene_, setup_.lit(),
                                config_.blur_reach, buffers, scheduler_, light);
    }
    return light;
  }

  std::vector<reconstruction::PictureMemory> join_pictures(
      std::span<const reconstruction::PictureMemory> last,
      std::span<const reconstruction::Movers> movers, FrameBuffers& out,
      FrameReport& report) const {
    std::vector<reconstruction::PictureMemory> now(request_.views.size());
    const bool remembers = last.size() == now.size();
    for (std::size_t v = 0; v < now.size() && !report.stopped; ++v) {
      report.stopped = steady_picture(request_.views[v], remembers ? &last[v] : nullptr, movers[v],
                                      config_.picture_frames, scheduler_, out.views[v],
                                      now[v]) == scheduling::Outcome::Stopped;
    }
    return now;
  }

  const FrameRequest& request_;
  const SceneFrame& scene_;
  const Config& config_;
  const LightSetup& setup_;
  TileScheduler& scheduler_;
};

std::vector<std::string> shortcuts(const SceneFrame& scene, const Config& config,
                                   const KeptLights& kept) {
  std::vector<std::string> taken = ray::shortcuts(scene);
  taken.emplace_back(base::concat("indirect light ends after one diffuse bounce, and nearer than ",
                                  kept.least_m, " m to its source counts as from there"));
  if (config.space == Space::Thinned) {
    taken.emplace_back(base::concat("indirect light is asked in a cell of ", config.texel_step,
                                    " x ", config.texel_step));
  }
  if (config.space == Space::LogPolar)
    taken.emplace_back("indirect light is asked in a log-polar picture");
  if (config.shadows == ray::VirtualShadows::None)
    taken.emplace_back("nothing hides virtual lights");
  if (config.source == LightSource::Camera)
    taken.emplace_back("indirect light that no shading point sees is lost");
  if (config.weights == CullWeights::None) taken.emplace_back("culled virtual lights are lost");
  if (config.blur_reach > 0)
    taken.emplace_back("cells share their area, ambient and indirect light with neighbours");
  if (config.newest < 1.0F) taken.emplace_back("these are averaged over frames");
  if (config.picture_frames > 1)
    taken.emplace_back(
        base::concat("the picture is averaged over ", config.picture_frames, " frames"));
  return taken;
}

bool follows_light(const Config& config, const SceneFrame& scene) {
  return config.indirect && scene.plan().has(scene::Step::VirtualLights);
}

}  // namespace

Config make_config(const KernelOptions& options) {
  Config config;
  config.ray = ray::make_config(options);
  config.ray.foveated.method = ray::Method::Full;  // it remembers light, not cells
  config.indirect = options.bounces.value_or(1) > 0;
  return config;
}

FrameReport CullingKernel::render(const FrameRequest& request, const SceneFrame& scene,
                                  History& history, TileScheduler& scheduler,
                                  FrameBuffers& out) const {
  if (!follows_light(config_, scene))
    return ray::RayKernel(config_.ray).render(request, scene, history, scheduler, out);
  const bool exact = config_.ray.mode == Mode::Exact;
  CullingHistory forgotten;
  CullingHistory& memory = exact ? forgotten : record_of<CullingHistory>(history);
  const KeptLights kept = keep_lights(request, scene, config_, memory, scheduler);
  const LightSetup setup(config_, kept);
  const bool in_cells = lights_in_cells(config_);
  const unsigned for_calming =
      exact ? 0U : kLight | kNormal | (has_moving_objects(scene) ? kSurfaceId : 0U);
  const unsigned wanted = std::exchange(out.wanted, out.wanted | for_calming);
  prepare_buffers(request.views, out);
  FrameReport report = kept.report;
  memory.made = kept.made, memory.kept = kept.lights.size(), memory.stages = kept.stages;
  StageClock clock;
  if (!report.stopped) {
    report +=
        ray::render_full(request, scene, in_cells ? setup.lit() : setup.lamps_alone(), scheduler,
                         out, exact ? Audience::RankZero : Audience::EveryRank, kept.cut_nodes);
  }
  memory.stages.shading_ms = clock.lap_ms();
  if (!report.stopped && !exact)
    report += Calming(request, scene, config_, setup, scheduler).run(memory, out);
  memory.stages.post_ms = clock.lap_ms();
  out.wanted = wanted;
  if (!report.stopped)
    report.stopped = fill_rate(request, scheduler, out) == scheduling::Outcome::Stopped;
  if (!exact) report.biased_shortcuts = shortcuts(scene, config_, kept);
  return report;
}

void CullingKernel::shade(std::span<const SurfacePoint> points, const SceneFrame& scene,
                          TileScheduler& scheduler, std::span<Rgb> out) const {
  KeptLights all;
  if (follows_light(config_, scene)) all = all_lights(scene, config_, 0, scheduler);
  const LightSetup setup(config_, all);
  ray::RayKernel(setup.lit()).shade(points, scene, scheduler, out);
}

}  // namespace macula::kernels::culling
