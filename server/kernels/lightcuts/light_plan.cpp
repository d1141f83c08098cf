#include "server/kernels/lightcuts/light_plan.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "server/kernels/lightcuts/cut_light.h"
#include "server/kernels/lightcuts/other_light.h"
#include "server/kernels/planes.h"
#include "server/kernels/ray/guide.h"
#include "server/scheduling/row_bands.h"
#include "shared/math/hash.h"

namespace macula::kernels::lightcuts {
namespace {

/// Told apart from the frame's own seed: sizes of cuts must not depend on what the cuts draw.
constexpr std::uint64_t kPictureSeed = 0x10'0A11'0001ULL;

/// As it is shown: contrast is told against a least luminance of the display's.
Plane<float> shown_luminance(const Plane<Rgb>& radiance, const image::Tone& tone) {
  Plane<float> luminance(radiance.width(), radiance.height());
  const float gain = std::exp2(tone.exposure_ev);
  std::ranges::transform(radiance.pixels(), luminance.pixels().begin(),
                         [gain](const Rgb& c) { return gain * image::luminance(c); });
  return luminance;
}

/// Lit at a few nodes a pixel, alike everywhere.
FrameReport light_low(const SceneFrame& scene, const Config& config, TileScheduler& scheduler,
                      LowViews& low) {
  FrameReport report;
  for (std::size_t v = 0; v < low.surfaces.size(); ++v) {
    const ViewSurfaces& view = low.surfaces[v];
    Plane<Rgb>& radiance = low.out.views[v].radiance;
    const Plane<std::uint16_t> nodes(view.width, view.height,
                                     static_cast<std::uint16_t>(config.low_nodes));
    std::vector<CutWork> works(view.tiles.size());
    const auto light_tile = [&](std::size_t k) {
      const SurfaceTile& tile = view.tiles[k];
      std::vector<Rgb> light(tile.points.count, Rgb{0.0F});
      add_lights_apart(scene, tile.points, works[k].lighting, light);
      add_cut_light(scene, tile, {nodes, config.low_nodes}, works[k], light);
      add_surroundings(scene, config.ray, tile.points, works[k].lighting, light);
      for (std::size_t i = 0; i < light.size(); ++i) {
        const image::Pixel at = tile.pixel(i);
        radiance(at.x, at.y) += light[i];
      }
    };
    const auto outcome = scheduling::run_shared(
        scheduler, view.tiles.size(), Audience::EveryRank, [&] { return view.places(v); },
        light_tile,
        [&](std::size_t k, Parcel& parcel) {
          parcel.value(works[k]);
          parcel.rect(radiance, view.tiles[k].rect);
        });
    for (const CutWork& work : works) report.shadow_rays += work.lighting.shadow_rays;
    report.stopped |= outcome == scheduling::Outcome::Stopped;
  }
  return report;
}

std::vector<Plane<float>> low_luminance(const SceneFrame& scene, const Config& config,
                                        TileScheduler& scheduler, LowViews& low,
                                        FrameReport& report) {
  std::vector<Plane<float>> luminance(low.views.size());
  if (config.low_nodes <= 0) return luminance;
  report += light_low(scene, config, scheduler, low);
  for (std::size_t v = 0; v < low.views.size(); ++v) {
    luminance[v] = shown_luminance(low.out.views[v].radiance, low.views[v].tone);
  }
  return luminance;
}

/// `rows` of a plane.
template <class T>
Plane<T> part_of(const Plane<T>& plane, const scheduling::Rows& rows) {
  if (plane.empty()) return {};
  Plane<T> part(plane.width(), rows.count());
  for (int y = rows.begin; y < rows.end; ++y)
    std::ranges::copy(plane.row(y), part.row(y - rows.begin).begin());
  return part;
}

/// The perception map of one view, in parts of a few rows.
class MapRows {
 public:
  MapRows(const FoveationMap& acuity, std::size_t view, const ViewBuffers& surfaces,
          const Plane<float>& speed, const PerceptionConfig& config)
      : acuity_(acuity), view_(view), surfaces_(surfaces), speed_(speed), config_(config) {
    for (Plane<float>* plane : {&made_.spatial, &made_.luminance, &made_.map})
      plane->resize(width(), height());
  }

  scheduling::Outcome make(const Plane<float>& luminance, TileScheduler& scheduler) {
    const SeenContrast seen = see_contrast(luminance, width(), height());
    scheduling::RowBands bands(scheduler, height());
    constexpr int kPart = 32;
    const bool by_frame = config_.mode == PerceptionMode::Printed;
    const auto outcome =
        bands.run_parts(by_frame ? bands.all() : bands.own(), by_frame ? height() : kPart,
                        [&](const scheduling::Rows& rows) { make_part(rows, seen); });
    if (outcome == scheduling::Outcome::Stopped) return outcome;
    return bands.gather(Audience::EveryRank,
                        [&](int y, Parcel& parcel) { parcel.values(made_.map.row(y)); });
  }
  PerceptionMap take() { return std::move(made_); }

 private:
  int width() const { return surfaces_.radiance.width(); }
  int height() const { return surfaces_.radiance.height(); }

  void make_part(const scheduling::Rows& rows, const SeenContrast& seen) {
    const scheduling::Rows beside{std::max(rows.begin - 1, 0), std::min(rows.end + 1, height())};
    Plane<float> acuity(width(), beside.count());
    for (int y = beside.begin; y < beside.end; ++y)
      acuity_.samples_wanted_row(view_, y, acuity.row(y - beside.begin));
    const Plane<float> nothing;
    const PerceptionMap part =
        make_perception_map({acuity, part_of(surfaces_.normal, beside),
                             part_of(surfaces_.albedo, beside), part_of(speed_, beside), nothing},
                            seen, beside.begin, config_);
    for (int y = rows.begin; y < rows.end; ++y) {
      const int from = y - beside.begin;
      std::ranges::copy(part.spatial.row(from), made_.spatial.row(y).begin());
      std::ranges::copy(part.luminance.row(from), made_.luminance.row(y).begin());
      std::ranges::copy(part.map.row(from), made_.map.row(y).begin());
    }
  }

  const FoveationMap& acuity_;
  std::size_t view_;
  const ViewBuffers& surfaces_;
  const Plane<float>& speed_;
  const PerceptionConfig& config_;
  PerceptionMap made_;
};

}  // namespace

LowViews trace_low_views(const FrameRequest& request, const SceneFrame& scene, const Config& config,
                         TileScheduler& scheduler) {
  LowViews low;
  low.views = ray::thinned(request.views, config.low_resolution);
  const FrameRequest thin{low.views, request.foveation, request.frame,
                          math::hash_combine(request.seed, kPictureSeed)};
  prepare_buffers(low.views, low.out);
  low.report = trace_surfaces(thin, scene, config.ray, scheduler, low.surfaces, low.out);
  return low;
}

LightPlan plan_lights(const FrameRequest& request, const SceneFrame& scene, const Config& config,
                      const FrameBuffers& surfaces, std::span<const Plane<float>> speeds,
                      LowViews& low, TileScheduler& scheduler) {
  LightPlan plan;
  auto luminance = low_luminance(scene, config, scheduler, low, plan.report);
  luminance.resize(request.views.size());
  if (plan.report.stopped) return plan;
  const auto begin = std::chrono::steady_clock::now();
  foveation::RateModel model;
  model.curve = foveation::RateCurve::Lightcuts;  // the paper's acuity
  const FoveationMap acuity = ray::acuity_map(request, model);
  const Plane<float> at_rest;
  for (std::size_t v = 0; v < request.views.size(); ++v) {
    const Plane<float>& speed = speeds.empty() ? at_rest : speeds[v];
    MapRows rows(acuity, v, surfaces.views[v], speed, config.perception);
    plan.report.stopped |= rows.make(luminance[v], scheduler) == scheduling::Outcome::Stopped;
    if (plan.report.stopped) return plan;
    plan.maps.push_back(rows.take());
    plan.cut_nodes.push_back(
        node_counts(plan.maps[v].map,
                    {config.most_nodes, std::min(config.least_nodes, config.most_nodes)},
                    config.mean_nodes)
            .nodes);
  }
  plan.report.mask_ms = units::to_ms(std::chrono::steady_clock::now() - begin);
  return plan;
}

LightPlan plan_lights(const FrameRequest& request, const SceneFrame& scene, const Config& config,
                      TileScheduler& scheduler) {
  FrameBuffers out;
  out.wanted = kNormal | kAlbedo;
  prepare_buffers(request.views, out);
  std::vector<ViewSurfaces> surfaces;
  FrameReport traced = trace_surfaces(request, scene, config.ray, scheduler, surfaces, out);
  LightPlan plan;
  if (!traced.stopped) {
    LowViews low;
    if (config.low_nodes > 0) low = trace_low_views(request, scene, config, scheduler);
    traced += low.report;
    if (!traced.stopped) plan = plan_lights(request, scene, config, out, {}, low, scheduler);
  }
  plan.report += traced;
  return plan;
}

}  // namespace macula::kernels::lightcuts
