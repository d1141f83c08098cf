#include "server/kernels/lightcuts/deferred.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "server/kernels/lightcuts/denoiser.h"
#include "server/kernels/lightcuts/other_light.h"
#include "server/kernels/lightcuts/reservoir_light.h"
#include "server/kernels/planes.h"
#include "server/kernels/ray/guide.h"
#include "shared/math/hash.h"

namespace macula::kernels::lightcuts {
namespace {

/// The map must not depend on draws that it decides to keep: they have a seed of their own.
constexpr std::uint64_t kKeptSeed = 0x10'0A11'0002ULL;

std::vector<LowPicture> draw_low(const FrameRequest& request, const SceneFrame& scene,
                                 const Config& config, TileScheduler& scheduler,
                                 FrameReport& report) {
  const std::vector<View> views = ray::thinned(request.views, config.low_resolution);
  const FrameRequest low{views, request.foveation, request.frame,
                         math::hash_combine(request.seed, kKeptSeed)};
  FrameBuffers unused;
  prepare_buffers(views, unused);
  std::vector<ViewSurfaces> surfaces;
  report += trace_surfaces(low, scene, config.ray, scheduler, surfaces, unused);
  std::vector<LowPicture> pictures(views.size());
  for (std::size_t v = 0; v < views.size() && !report.stopped; ++v) {
    pictures[v].factor = config.low_resolution;
    report += draw_low_picture(scene, surfaces[v], v, config.kept_nodes, scheduler, pictures[v]);
  }
  return pictures;
}

void fill_sample_planes(unsigned wanted, ViewBuffers& out) {
  if (wanted & kSamples) {
    for (float& each : out.samples.pixels()) each = 1.0F;
  }
  if (wanted & kVariance) {
    for (float& each : out.variance.pixels()) each = std::numeric_limits<float>::infinity();
  }
}

class Frame {
 public:
  Frame(const FrameRequest& request, const SceneFrame& scene, const Config& config,
        TileScheduler& scheduler, FrameBuffers& out)
      : request_(request), scene_(scene), config_(config), scheduler_(scheduler), out_(out) {}

  FrameReport run(History& history) {
    trace();
    plan();
    if (!report_.stopped && config_.source != LightSource::Walks && perceived()) {
      low_ = draw_low(request_, scene_, config_, scheduler_, report_);
    }
    auto* last = dynamic_cast<LightHistory*>(history.record.get());
    if (last != nullptr && last->views.size() != request_.views.size()) last = nullptr;
    auto kept = std::make_unique<LightHistory>();
    kept->views.resize(request_.views.size());
    for (std::size_t v = 0; v < request_.views.size() && !report_.stopped; ++v) {
      look(v);
      light(v, last != nullptr ? &last->views[v] : nullptr, kept->views[v]);
      fill_sample_planes(out_.wanted, out_.views[v]);
    }
    if (remembers() && !report_.stopped) keep(std::move(kept), history);
    return report_;
  }

 private:
  bool perceived() const { return config_.sizes == CutSizes::Perceived; }
  bool denoises() const { return config_.denoise == Denoise::Yes; }
  /// Samples at fixed places are what they are, over any number of frames.
  bool steadies() const { return denoises() && config_.ray.placement == ray::Placement::Jittered; }
  bool remembers() const { return reservoirs() || denoises(); }
  bool reservoirs() const { return perceived() && config_.source == LightSource::Reservoirs; }

  void trace() {
    const unsigned wanted = out_.wanted;
    if (perceived()) out_.wanted |= kNormal | kAlbedo;  // the map's features
    prepare_buffers(request_.views, out_);
    report_ = trace_surfaces(request_, scene_, config_.ray, scheduler_, surfaces_, out_);
    if (perceived() && !report_.stopped) {
      plan_ = plan_lights(request_, scene_, config_, out_, scheduler_);
      report_ += plan_.report;
    }
    out_.wanted = wanted;
  }
  void plan() {
    if (perceived()) return;
    for (const ViewSurfaces& view : surfaces_) {
      plan_.cut_nodes.emplace_back(view.width, view.height,
                                   static_cast<std::uint16_t>(config_.ray.area_light_samples));
    }
  }
  CutPlan cuts(std::size_t v) const {
    if (!perceived()) return {plan_.cut_nodes[v], config_.ray.area_light_samples};
    return {plan_.cut_nodes[v], config_.most_nodes, &plan_.maps[v].map,
            low_.empty() ? nullptr : &low_[v]};
  }
  void look(std::size_t v) {
    eccentricity_.resize(surfaces_[v].width, surfaces_[v].height);
    for (int y = 0; y < surfaces_[v].height; ++y) {
      request_.foveation.eccentricity_row(v, y, eccentricity_.row(y));
    }
  }

  void light(std::size_t v, const KeptView* last, KeptView& kept) {
    const ViewSurfaces& view = surfaces_[v];
    if (reservoirs()) kept.reservoirs.resize(view.width, view.height);
    light_.resize(view.width, view.height);
    std::ranges::fill(light_.pixels(), Rgb{0.0F});
    std::vector<FrameReport> parts(view.tiles.size());
    const CutPlan plan = cuts(v);
    const auto outcome = scheduling::run_shared(
        scheduler_, parts.size(), Audience::EveryRank, [&] { return places(v, plan); },
        [&](std::size_t k) { parts[k] = light_tile(view.tiles[k], plan, last, kept); },
        [&](std::size_t k, Parcel& parcel) {
          kernels::carry(parts[k], parcel);
          parcel.rect(light_, view.tiles[k].rect);
          parcel.rect(kept.reservoirs, view.tiles[k].rect);
        });
    for (const FrameReport& part : parts) report_ += part;
    report_.stopped |= outcome == scheduling::Outcome::Stopped;
    if (!report_.stopped && denoises()) smooth(v, last, kept);
    for (std::size_t k = 0; k < view.tiles.size() && !report_.stopped; ++k) deliver(v, k);
    if (!report_.stopped && steadies()) steady(v, last, kept);
  }
  /// A tile's work: the nodes its cells ask, and what every cell costs.
  std::vector<scheduling::TilePlace> places(std::size_t v, const CutPlan& plan) const {
    std::vector<scheduling::TilePlace> places = surfaces_[v].places(v);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const image::Rect& rect = surfaces_[v].tiles[k].rect;
      for (int y = rect.y; y < rect.y + rect.height; ++y)
        for (int x = rect.x; x < rect.x + rect.width; ++x)
          places[k].work += static_cast<float>(plan.nodes(x, y));
    }
    return places;
  }
  FrameReport light_tile(const SurfaceTile& tile, const CutPlan& plan, const KeptView* last,
                         KeptView& kept) {
    FrameReport report;
    CutWork work;
    std::vector<Rgb> slots(tile.points.count, Rgb{0.0F});
    add_lights_apart(scene_, tile.points, work.lighting, slots);
    if (reservoirs()) {
      add_reservoir_light(scene_, tile, plan, config_.reservoirs, last, eccentricity_, work,
                          kept.reservoirs, slots);
    } else {
      add_cut_light(scene_, tile, plan, work, slots);
    }
    add_surroundings(scene_, config_.ray, tile.points, work.lighting, slots);
    for (std::size_t i = 0; i < slots.size(); ++i) {
      const image::Pixel at = tile.pixel(i);
      light_(at.x, at.y) = slots[i];
    }
    report.shadow_rays = work.lighting.shadow_rays;
    report.trace_ms = work.lighting.trace_ms;
    report.walked_nodes = work.walked, report.taken_nodes = work.taken;
    return report;
  }

  /// Light over reflectance, so that textures stay sharp; a channel without any has no light.
  void smooth(std::size_t v, const KeptView* last, KeptView& kept) {
    const auto begin = std::chrono::steady_clock::now();
    constexpr float kLeast = 1e-3F;
    const auto scale = [&](const auto& by) {
      for (const SurfaceTile& tile : surfaces_[v].tiles) {
        for (std::size_t i = 0; i < tile.points.count; ++i) {
          const image::Pixel at = tile.pixel(i);
          Rgb& light = light_(at.x, at.y);
          if (!math::is_finite(light)) light = Rgb{0.0F};
          light *= by(glm::max(tile.points.reflectors.reflectance[i], Rgb{kLeast}));
        }
      }
    };
    scale([](const Rgb& reflectance) { return Rgb{1.0F} / reflectance; });
    const bool is_known = last != nullptr && last->memory.surfaces.width() > 0;
    const DenoiseJob job{request_.views[v], surfaces_[v], eccentricity_, plan_.cut_nodes[v],
                         is_known ? &last->memory : nullptr};
    report_.stopped |=
        denoise(job, scheduler_, light_, kept.memory) == scheduling::Outcome::Stopped;
    scale([](const Rgb& reflectance) { return reflectance; });
    report_.post_ms += units::to_ms(std::chrono::steady_clock::now() - begin);
  }

  /// Radiance that is no number becomes black, and is counted.
  void deliver(std::size_t v, std::size_t k) {
    const SurfaceTile& tile = surfaces_[v].tiles[k];
    for (std::size_t i = 0; i < tile.points.count; ++i) {
      const image::Pixel at = tile.pixel(i);
      Rgb& radiance = out_.views[v].radiance(at.x, at.y);
      radiance += light_(at.x, at.y);
      if (math::is_finite(radiance)) continue;
      radiance = Rgb{0.0F};
      ++report_.non_finite_samples;
    }
  }

  void steady(std::size_t v, const KeptView* last, KeptView& kept) {
    const auto begin = std::chrono::steady_clock::now();
    ViewBuffers& view = out_.views[v];
    Plane<float> inverse_depth(view.depth_m.width(), view.depth_m.height());
    std::ranges::transform(view.depth_m.pixels(), inverse_depth.pixels().begin(),
                           [](float depth) { return 1.0F / depth; });
    kept.picture.world_from_view = request_.views[v].world_from_view;
    kept.picture.grid = request_.views[v].grid;
    const reconstruction::SteadyConfig settings;
    reconstruction::PictureJoin joined(last != nullptr ? &last->picture : nullptr, settings,
                                       view.radiance, inverse_depth, kept.picture);
    Plane<Rgb> shown(view.radiance.width(), view.radiance.height());
    const auto rows = static_cast<std::size_t>(shown.height());
    const auto prepared =
        scheduler_.run(rows, [&](std::size_t y) { joined.prepare_row(static_cast<int>(y)); });
    const auto outcome = scheduler_.run(rows, [&](std::size_t y) {
      joined.join_row(static_cast<int>(y), shown.row(static_cast<int>(y)));
    });
    report_.stopped |=
        prepared == scheduling::Outcome::Stopped || outcome == scheduling::Outcome::Stopped;
    view.radiance = std::move(shown);
    report_.post_ms += units::to_ms(std::chrono::steady_clock::now() - begin);
  }

  void keep(std::unique_ptr<LightHistory> kept, History& history) {
    for (std::size_t v = 0; v < surfaces_.size(); ++v) {
      kept->views[v].view = request_.views[v];
      if (reservoirs()) kept->views[v].surfaces = std::move(surfaces_[v]);
    }
    history.record = std::move(kept);
  }

  const FrameRequest& request_;
  const SceneFrame& scene_;
  const Config& config_;
  TileScheduler& scheduler_;
  FrameBuffers& out_;
  FrameReport report_;
  std::vector<ViewSurfaces> surfaces_;
  LightPlan plan_;
  std::vector<LowPicture> low_;
  Plane<float> eccentricity_;  ///< of the view at work, radians
  Plane<Rgb> light_;           ///< its light, without what surfaces emit
};

}  // namespace

FrameReport render_deferred(const FrameRequest& request, const SceneFrame& scene,
                            const Config& config, History& history, TileScheduler& scheduler,
                            FrameBuffers& out) {
  return Frame(request, scene, config, scheduler, out).run(history);
}

}  // namespace macula::kernels::lightcuts
