#include "server/kernels/culling/look.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/kernels/culling/importance.h"
#include "server/kernels/culling/shading_points.h"
#include "server/kernels/ray/guide.h"
#include "server/reconstruction/backward_warp.h"
#include "shared/image/color.h"

namespace macula::kernels::culling {
namespace {

using sampling::SampleKey;

constexpr std::uint64_t kPointsKey = 0xC0117'0001ULL;

/// Brightness of indirect light remembered where each cell's surface lay in the last frame;
/// infinite where it is not known.
Plane<float> remembered_brightness(const View& view, const ViewBuffers& surfaces,
                                   const ViewMemory& then) {
  const reconstruction::BackwardWarp warp(view.world_from_view, then.world_from_view, then.grid);
  const float gain = std::exp2(view.tone.exposure_ev);
  Plane<float> brightness(surfaces.depth_m.width(), surfaces.depth_m.height(),
                          std::numeric_limits<float>::infinity());
  for (int y = 0; y < brightness.height(); ++y) {
    for (int x = 0; x < brightness.width(); ++x) {
      const auto place = warp.then(view.grid.tangent(x, y), surfaces.depth_m(x, y));
      if (!place) continue;
      const int tx = static_cast<int>(place->cell.x), ty = static_cast<int>(place->cell.y);
      if (!then.light.contains(tx, ty)) continue;
      brightness(x, y) = std::min(gain * image::luminance(then.light(tx, ty)), 1.0F);
    }
  }
  return brightness;
}

Plane<float> importance_of(const View& view, const ViewBuffers& surfaces,
                           const Plane<float>& acuity, const ViewMemory* then,
                           const ImportanceConfig& config) {
  const Plane<float> unknown;
  const Plane<float> known =
      then != nullptr ? remembered_brightness(view, surfaces, *then) : Plane<float>{};
  return make_importance({acuity, surfaces.depth_m, surfaces.normal, surfaces.albedo,
                          then != nullptr ? known : unknown},
                         config);
}

/// Acuity in [0, 1] and area in nominal pixels of every cell.
struct Acuity {
  Plane<float> rate, area;
};
Acuity acuity_in(const FoveationMap& map, std::size_t view, const PixelGrid& grid) {
  Acuity acuity{Plane<float>(grid.width(), grid.height()),
                Plane<float>(grid.width(), grid.height())};
  for (int y = 0; y < grid.height(); ++y) {
    const std::span<float> rate = acuity.rate.row(y), area = acuity.area.row(y);
    map.rate_row(view, y, rate);
    map.samples_wanted_row(view, y, area);
    for (std::size_t x = 0; x < rate.size(); ++x) area[x] /= rate[x];
  }
  return acuity;
}

Plane<float> weights_of(const Plane<float>& importance, const Acuity& acuity, float in_fovea) {
  Plane<float> weights = importance;
  for (std::size_t i = 0; i < weights.size(); ++i) weights.pixels()[i] *= acuity.area.pixels()[i];
  focus(acuity.rate, in_fovea, weights);
  return weights;
}

ShadingPoint shading_point(const View& view, const ViewBuffers& surfaces,
                           const image::Pixel& cell) {
  const DVec3 direction =
      view.world_from_view.transform_direction(DVec3(view.grid.ray(cell.x, cell.y)));
  const double depth = surfaces.depth_m(cell.x, cell.y);
  ShadingPoint point;
  point.position = Vec3(view.world_from_view.position + depth * direction);
  const Vec3 normal = surfaces.normal(cell.x, cell.y);
  point.normal = glm::dot(normal, Vec3(direction)) > 0.0F ? -normal : normal;
  point.distance_m = static_cast<float>(depth * glm::length(direction));
  point.albedo = image::luminance(surfaces.albedo(cell.x, cell.y));
  return point;
}

/// Shading points over all views, each view's share by its importance.
class PointDrawing {
 public:
  PointDrawing(const Config& config, SampleKey key) : config_(config), key_(key) {}

  void add(const View& view, const ViewBuffers& surfaces, const Plane<float>& weights, int count) {
    const auto cells = config_.points == PointDraw::Systematic
                           ? draw_systematically(weights, count, sampling::sample(key_, 0))
                           : draw_by_chains(weights, count, config_.chain_length, key_);
    for (const image::Pixel& cell : cells) points_.push_back(shading_point(view, surfaces, cell));
  }
  const std::vector<ShadingPoint>& points() const { return points_; }

 private:
  const Config& config_;
  SampleKey key_;
  std::vector<ShadingPoint> points_;
};

}  // namespace

Look look(const FrameRequest& request, const SceneFrame& scene, const Config& config,
          const CullingHistory& memory, TileScheduler& scheduler) {
  Look seen;
  seen.views = ray::thinned(request.views, config.guide_step);
  const FrameRequest guide{seen.views, request.foveation, request.frame, request.seed};
  seen.surfaces =
      ray::trace_surfaces(guide, scene, config.ray, kNormal | kAlbedo, scheduler, seen.report);
  if (seen.report.stopped) return seen;
  const FoveationMap map = ray::acuity_map(guide, config.importance.acuity);
  const bool remembers = memory.views.size() == seen.views.size();
  for (std::size_t v = 0; v < seen.views.size(); ++v) {
    const ViewMemory* then = remembers ? &memory.views[v] : nullptr;
    const Acuity acuity = acuity_in(map, v, seen.views[v].grid);
    seen.importance.push_back(
        importance_of(seen.views[v], seen.surfaces.views[v], acuity.rate, then, config.importance));
    seen.weights.push_back(weights_of(seen.importance.back(), acuity, config.points_in_fovea));
  }
  return seen;
}

std::vector<ShadingPoint> draw_points(const Look& seen, const Config& config, int count,
                                      std::uint64_t seed, std::uint64_t frame) {
  PointDrawing drawing(config, {seed, frame, kPointsKey});
  const int each = std::max(count / static_cast<int>(seen.views.size()), 1);
  for (std::size_t v = 0; v < seen.weights.size(); ++v)
    drawing.add(seen.views[v], seen.surfaces.views[v], seen.weights[v], each);
  return drawing.points();
}

}  // namespace macula::kernels::culling
