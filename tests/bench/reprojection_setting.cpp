#include "tests/bench/reprojection_setting.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/kernels/registry.h"
#include "server/scene/load.h"

namespace macula::bench {
namespace {

using base::forward;

std::vector<float> raster_edges(double low, double high, double step, double reach_low,
                                double reach_high) {
  const int count = static_cast<int>(std::lround((high - low) / step));
  const int before = static_cast<int>(std::ceil((low - reach_low) / step));
  const int after = static_cast<int>(std::ceil((reach_high - high) / step));
  std::vector<float> edges;
  for (int i = -before; i <= count + after; ++i) {
    edges.push_back(static_cast<float>(low + i * step));
  }
  return edges;
}

/// The tangent `guard` beyond the tangent `edge`, away from the axis.
double widened(double edge, Degrees guard) {
  const double most = Radians{Degrees{80.0}}.value();
  const double angle = std::abs(std::atan(edge)) + Radians{guard}.value();
  return std::copysign(std::tan(std::min(angle, most)), edge);
}

kernels::KernelOptions kernel_options(const std::string& material) {
  kernels::KernelOptions options;
  options.mode = kernels::Mode::Exact;
  options.samples_per_cell = 9;
  options.jitter = false;
  options.lambert_only = material == "lambert";
  options.ambient_samples = material == "lambert" ? 0 : 4;
  return options;
}

}  // namespace

PixelGrid guarded_raster(const foveation::Display& display, Degrees guard, double scale) {
  const DVec2 step = display.pixel_tangent() / scale;
  const DVec2 low = display.fov.tangent_min(), high = display.fov.tangent_max();
  return {raster_edges(low.x, high.x, step.x, widened(low.x, guard), widened(high.x, guard)),
          raster_edges(low.y, high.y, step.y, widened(low.y, guard), widened(high.y, guard))};
}

Result<ReprojectionSetting> ReprojectionSetting::create(const std::string& name,
                                                        const std::string& material, int threads) {
  const auto scene = scene::load_scene(name);
  if (!scene) return forward(scene);
  ReprojectionSetting setting;
  setting.tone_ = (*scene)->settings.tone;
  setting.scene_from_stage_ = (*scene)->settings.scene_from_stage;
  auto frame = kernels::SceneFrame::create(*scene);
  if (!frame) return forward(frame);
  setting.frame_ = *frame;
  const char* const kernel = (*scene)->field ? "sphere" : "ray";
  if (const auto fits = kernels::check_scene(kernel, **scene); !fits) return forward(fits);
  auto made = kernels::make_kernel(kernel, kernel_options(material));
  if (!made) return forward(made);
  setting.kernel_ = std::move(*made);
  setting.scheduler_ = std::make_unique<kernels::TileScheduler>(threads);
  const auto& cameras = setting.frame_->pose().world_from_view;
  if (!cameras.empty()) {
    setting.stage_from_camera_ = inverse(setting.scene_from_stage_) * cameras.front();
  }
  return setting;
}

SourcePicture ReprojectionSetting::render(const Pose& stage_from_view, const PixelGrid& grid) {
  const kernels::View view{scene_from_stage_ * stage_from_view, grid, {}, tone_};
  const DVec2 cell(grid.footprint(grid.width() / 2, grid.height() / 2));
  const FoveationMap full({{grid, {}, cell}}, {.curve = foveation::RateCurve::Uniform});
  kernels::FrameBuffers buffers;
  kernels::History history;
  kernel_->render({{&view, 1}, full, 0, 0}, *frame_, history, *scheduler_, buffers);
  SourcePicture picture{stage_from_view, grid, {}, {grid.width(), grid.height()}};
  image::encode(tone_, buffers.views[0].radiance, picture.color);
  const auto depths = buffers.views[0].depth_m.pixels();
  std::transform(depths.begin(), depths.end(), picture.inverse_depth_per_m.data(),
                 [](float depth_m) { return 1.0F / depth_m; });
  return picture;
}

}  // namespace macula::bench
