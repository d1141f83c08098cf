#include "server/kernels/ray/ray_kernel.h"

#include <algorithm>

#include "server/kernels/planes.h"
#include "server/kernels/ray/foveated.h"
#include "server/kernels/ray/full.h"
#include "server/kernels/ray/shading_point.h"
#include "shared/base/check.h"

namespace macula::kernels::ray {
std::vector<std::string> shortcuts(const SceneFrame& scene) {
  std::vector<std::string> taken{
      "textures are averaged over the cell before shading (trilinear, isotropic)"};
  if (scene.triangles().blends()) {
    taken.emplace_back(
        "a blended surface is met by a fixed share of a cell's samples, and those behind it too");
  }
  return taken;
}

FrameReport RayKernel::render(const FrameRequest& request, const SceneFrame& scene,
                              History& history, TileScheduler& scheduler, FrameBuffers& out) const {
  prepare_buffers(request.views, out);
  const bool foveated = config_.mode == Mode::Fast && config_.foveated.method == Method::Foveated;
  FrameReport report =
      foveated ? render_foveated(request, scene, config_, history, scheduler, out)
               : render_full(request, scene, config_, scheduler, out, Audience::RankZero);
  if (!report.stopped) {
    report.stopped = fill_rate(request, scheduler, out) == scheduling::Outcome::Stopped;
  }
  if (config_.mode == Mode::Fast) report.biased_shortcuts = shortcuts(scene);
  return report;
}

void RayKernel::shade(std::span<const SurfacePoint> points, const SceneFrame& scene,
                      TileScheduler& scheduler, std::span<Rgb> out) const {
  MACULA_CHECK(points.size() == out.size());
  constexpr std::size_t kBatch = visibility::kStreamCapacity;
  const Lighting lighting(scene, config_);
  scheduler.run((points.size() + kBatch - 1) / kBatch, [&](std::size_t batch) {
    const std::size_t first = batch * kBatch;
    const std::size_t count = std::min(kBatch, points.size() - first);
    shade_batch(points.subspan(first, count), scene, config_, lighting, out.subspan(first, count));
  });
}

}  // namespace macula::kernels::ray
