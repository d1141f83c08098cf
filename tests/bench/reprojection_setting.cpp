#include "tests/bench/reprojection_setting.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/kernels/registry.h"
#include "server/scene/load.h"
#include "tests/bench/stopwatch.h"

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

image::Plane<float> inverse_of(const image::Plane<float>& depth_m) {
  image::Plane<float> inverse(depth_m.width(), depth_m.height());
  const auto depths = depth_m.pixels();
  std::transform(depths.begin(), depths.end(), inverse.data(),
                 [](float depth) { return 1.0F / depth; });
  return inverse;
}

void compose_hidden(SourcePicture& picture) {
  const codec::HiddenLayerPlanes& behind = *picture.behind;
  picture.hidden =
      reprojection::make_hidden_picture(picture.color, picture.inverse_depth_per_m, behind.mask,
                                        behind.color, behind.inverse_depth_per_m);
}

Result<void> code_hidden(SourcePicture& picture) {
  codec::HiddenLayerPlanes& behind = *picture.behind;
  const image::Rect atlas = codec::atlas_rect(behind.mask);
  if (atlas.height == 0) return {};
  codec::ColorOptions options;
  options.jpeg_quality = codec::hidden_jpeg_quality(options.jpeg_quality);
  const auto bytes = codec::encode_hidden_layer(behind.mask, behind.color,
                                                inverse_of(behind.inverse_depth_per_m), options);
  if (!bytes) return forward(bytes);
  image::Plane<Rgb8> color(atlas.width, atlas.height);
  if (auto done = codec::decode_color(bytes->color, options.codec, atlas, color); !done)
    return done;
  codec::unpack_atlas(behind.mask, color, behind.color);
  picture.hidden_bytes = bytes->bytes();
  return codec::decode_depth(bytes->depth.bytes, bytes->depth.inverse_scale_per_m,
                             behind.inverse_depth_per_m);
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

Result<SourcePicture> coded(const SourcePicture& picture) {
  SourcePicture result = picture;
  const auto color = codec::encode_color(picture.color, picture.color.rect(), {});
  if (!color) return forward(color);
  if (auto done =
          codec::decode_color(*color, codec::ColorCodec::Jpeg, picture.color.rect(), result.color);
      !done) {
    return forward(done);
  }
  auto depth = codec::encode_depth(inverse_of(picture.inverse_depth_per_m));
  if (!depth) return forward(depth);
  if (auto done =
          codec::decode_depth(depth->bytes, depth->inverse_scale_per_m, result.inverse_depth_per_m);
      !done) {
    return forward(done);
  }
  result.depth_residual = std::move(depth->residual);
  result.residual_step_per_m = codec::residual_step_per_m(depth->inverse_scale_per_m);
  if (result.behind) {
    if (auto done = code_hidden(result); !done) return forward(done);
    compose_hidden(result);
  }
  result.bytes = color->size() + depth->bytes.size() + result.hidden_bytes;
  return result;
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

void ReprojectionSetting::add_hidden(const kernels::View& view, const image::Plane<float>& depth_m,
                                     double view_cell_m, SourcePicture& picture) {
  Stopwatch watch;
  disocclusion::HiddenLayer layer;
  disocclusion::trace_hidden_layer({view, depth_m, view_cell_m}, *kernel_, *frame_, *scheduler_,
                                   layer);
  picture.hidden_cpu_ms = watch.lap().cpu_ms;
  picture.hidden_cells_pct =
      100.0 * static_cast<double>(layer.cells) / static_cast<double>(depth_m.size());
  image::Plane<Rgb8> color(depth_m.width(), depth_m.height());
  image::encode(tone_, layer.radiance, color);
  picture.behind = {std::move(layer.band), std::move(color), inverse_of(layer.depth_m)};
  compose_hidden(picture);
}

SourcePicture ReprojectionSetting::render(const Pose& stage_from_view, const PixelGrid& grid,
                                          double view_cell_m) {
  const kernels::View view{scene_from_stage_ * stage_from_view, grid, {}, tone_};
  const DVec2 cell(grid.footprint(grid.width() / 2, grid.height() / 2));
  const FoveationMap full({{grid, {}, cell}}, {.curve = foveation::RateCurve::Uniform});
  kernels::FrameBuffers buffers;
  kernels::History history;
  Stopwatch watch;
  kernel_->render({{&view, 1}, full, 0, 0}, *frame_, history, *scheduler_, buffers);
  const kernels::ViewBuffers& rendered = buffers.views[0];
  SourcePicture picture{stage_from_view, grid, {}, inverse_of(rendered.depth_m)};
  picture.cpu_ms = watch.lap().cpu_ms;
  image::encode(tone_, rendered.radiance, picture.color);
  if (view_cell_m > 0.0) add_hidden(view, rendered.depth_m, view_cell_m, picture);
  return picture;
}

image::Plane<float> ReprojectionSetting::depth(const Pose& stage_from_view, const PixelGrid& grid) {
  const Pose world_from_view = scene_from_stage_ * stage_from_view;
  const Mat3 rotation(glm::mat3_cast(world_from_view.rotation));
  const Vec3 origin(world_from_view.position);
  image::Plane<float> inverse(grid.width(), grid.height());
  scheduler_->run(static_cast<std::size_t>(grid.height()), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    visibility::RayStream rays;
    visibility::HitStream hits;
    for (int first = 0; first < grid.width(); first += visibility::kStreamCapacity) {
      const int count = std::min(visibility::kStreamCapacity, grid.width() - first);
      rays.clear();
      for (int i = 0; i < count; ++i) {
        rays.push(origin, rotation * grid.ray(first + i, y), 0.0F, INFINITY);
      }
      frame_->intersect(rays, hits, visibility::Coherence::Coherent);
      for (int i = 0; i < count; ++i) {
        inverse(first + i, y) = hits.hit(i) ? 1.0F / hits.t[i] : 0.0F;
      }
    }
  });
  return inverse;
}

}  // namespace macula::bench
