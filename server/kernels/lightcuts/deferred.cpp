#include "server/kernels/lightcuts/deferred.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "server/kernels/lightcuts/denoiser.h"
#include "server/kernels/lightcuts/gloss.h"
#include "server/kernels/lightcuts/other_eye.h"
#include "server/kernels/lightcuts/other_light.h"
#include "server/kernels/lightcuts/reservoir_light.h"
#include "server/kernels/lightcuts/retinal_speed.h"
#include "server/kernels/planes.h"
#include "server/kernels/ray/guide.h"
#include "shared/math/hash.h"

namespace macula::kernels::lightcuts {
namespace {

/// The map must not depend on draws that it decides to keep: they have a seed of their own.
constexpr std::uint64_t kKeptSeed = 0x10'0A11'0002ULL;

std::vector<LowPicture> draw_low(const FrameRequest& request, const SceneFrame& scene,
                                 const Config& config, LowViews& low, TileScheduler& scheduler,
                                 FrameReport& report) {
  const std::uint64_t seed = math::hash_combine(request.seed, kKeptSeed);
  std::vector<LowPicture> pictures(low.views.size());
  for (std::size_t v = 0; v < low.views.size() && !report.stopped; ++v) {
    give_keys(low.views[v].grid, seed, request.frame, low.surfaces[v]);
    pictures[v].factor = config.low_resolution;
    report +=
        draw_low_picture(scene, low.surfaces[v], v, config.kept_nodes, scheduler, pictures[v]);
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
    auto* last = dynamic_cast<LightHistory*>(history.record.get());
    if (last != nullptr) {
      surfaces_ = std::move(last->spare);
      spare_reservoirs_ = std::move(last->spare_reservoirs);
    }
    const LightHistory* before =
        last != nullptr && last->views.size() == request_.views.size() ? last : nullptr;
    gloss_ = config_.gloss == Gloss::Yes && has_gloss(scene_, config_.ray) ? Gloss::Yes : Gloss::No;
    if (gloss_ == Gloss::Yes) lamp_area_m2_ = lamp_area(scene_);
    trace(before);
    plan();
    if (last != nullptr && last->views.size() != request_.views.size()) last = nullptr;
    auto kept = std::make_unique<LightHistory>();
    kept->views.resize(request_.views.size());
    for (std::size_t v = 0; v < request_.views.size() && !report_.stopped; ++v) {
      look(v);
      light(v, last != nullptr ? &last->views[v] : nullptr, kept->views[v]);
      fill_sample_planes(out_.wanted, out_.views[v]);
    }
    if (remembers() && !report_.stopped) keep(std::move(kept), last, history);
    return report_;
  }

 private:
  bool perceived() const { return config_.sizes == CutSizes::Perceived; }
  bool denoises() const { return config_.denoise == Denoise::Yes; }
  /// Samples at fixed places are what they are, over any number of frames.
  bool steadies() const { return denoises() && config_.ray.placement == ray::Placement::Jittered; }
  bool remembers() const { return reservoirs() || denoises(); }
  bool reuses(std::size_t v) const { return v > 0 && config_.stereo == StereoReuse::Yes; }
  bool reservoirs() const { return perceived() && config_.source == LightSource::Reservoirs; }

  void trace(const LightHistory* last) {
    const unsigned wanted = out_.wanted;
    if (perceived()) out_.wanted |= kNormal | kAlbedo | kSurfaceId;  // the map's features
    prepare_buffers(request_.views, out_);
    report_ = trace_surfaces(request_, scene_, config_.ray, scheduler_, surfaces_, out_);
    if (perceived() && !report_.stopped) perceive(last);
    out_.wanted = wanted;
  }
  /// The map, and what it lets cells take from others.
  void perceive(const LightHistory* last) {
    const bool draws = config_.source != LightSource::Walks;
    LowViews low;
    if (draws || config_.low_nodes > 0)
      low = trace_low_views(request_, scene_, config_, scheduler_);
    report_ += low.report;
    if (report_.stopped) return;
    plan_ = plan_lights(request_, scene_, config_, out_, speeds_since(last), low, scheduler_);
    report_ += plan_.report;
    if (draws && !report_.stopped)
      low_ = draw_low(request_, scene_, config_, low, scheduler_, report_);
  }
  /// None where the scene's clock does not tell how long ago the last frame was: it rests, starts
  /// or leaps.
  std::vector<Plane<float>> speeds_since(const LightHistory* last) {
    constexpr double kLeap_s = 0.5;
    std::vector<Plane<float>> speeds;
    if (last == nullptr) return speeds;
    const double seconds = units::to_s(scene_.time().since_start - last->pose.time.since_start);
    if (!(seconds > 0.0 && seconds < kLeap_s)) return speeds;
    if (last->pose.world_from_object.size() != scene_.pose().world_from_object.size())
      return speeds;
    const auto motions = scene::motions_between(last->pose, scene_.pose());
    for (std::size_t v = 0; v < surfaces_.size(); ++v) {
      const Passage passage{last->views[v].view, request_.views[v], motions, seconds};
      speeds.push_back(retinal_speed(passage, surfaces_[v], out_.views[v].surface_id, scheduler_));
    }
    return speeds;
  }
  void plan() {
    if (perceived()) return;
    for (const ViewSurfaces& view : surfaces_) {
      plan_.cut_nodes.emplace_back(view.width, view.height,
                                   static_cast<std::uint16_t>(config_.ray.area_light_samples));
    }
  }
  CutPlan cuts(std::size_t v) const {
    const bool draws = perceived() && !low_.empty();
    return {plan_.cut_nodes[v],
            perceived() ? config_.most_nodes : config_.ray.area_light_samples,
            perceived() ? &plan_.maps[v].map : nullptr,
            draws ? &low_[v] : nullptr,
            gloss_,
            lamp_area_m2_,
            denoises()};
  }
  /// How far the denoiser smooths.
  void look(std::size_t v) {
    if (!denoises()) return;
    const ViewSurfaces& view = surfaces_[v];
    eccentricity_.resize(view.width, view.height);
    scheduling::RowBands bands(scheduler_, view.height);
    const auto outcome = bands.run(bands.own(), [&](int y) {
      request_.foveation.eccentricity_row(v, y, eccentricity_.row(y));
    });
    report_.stopped |= outcome == scheduling::Outcome::Stopped;
  }

  void light(std::size_t v, KeptView* last, KeptView& kept) {
    const ViewSurfaces& view = surfaces_[v];
    if (reservoirs()) take_spare(v, kept.reservoirs);
    light_.resize(view.width, view.height, Rgb{0.0F});
    std::vector<FrameReport> parts(view.tiles.size());
    const CutPlan plan = cuts(v);
    std::optional<OtherEye> other;
    if (reuses(v)) other.emplace(request_.views[0], surfaces_[0], first_light_, request_.views[v]);
    const auto outcome = scheduling::run_shared(
        scheduler_, parts.size(), Audience::EveryRank, [&] { return places(v, plan); },
        [&](std::size_t k) {
          clear(view.tiles[k].rect, kept.reservoirs);
          parts[k] = other ? light_rest(*other, v, view.tiles[k], plan, last, kept)
                           : light_tile(v, view.tiles[k], plan, last, kept);
        },
        [&](std::size_t k, Parcel& parcel) {
          kernels::carry(parts[k], parcel);
          parcel.rect(light_, view.tiles[k].rect);
          parcel.rect(kept.reservoirs, view.tiles[k].rect);
        });
    for (const FrameReport& part : parts) report_ += part;
    report_.stopped |= outcome == scheduling::Outcome::Stopped;
    if (v == 0 && reuses(request_.views.size() - 1)) first_light_ = light_;
    scheduling::RowBands bands(scheduler_, view.height);
    if (!report_.stopped && denoises()) smooth(v, bands, last, kept);
    if (!report_.stopped) deliver(v, bands);
    if (!report_.stopped && steadies()) steady(v, bands, last, kept);
    if (!report_.stopped) hand_over(v, bands);
  }
  /// Memory of a frame that is over, as that left it: tiles clear what is theirs.
  void take_spare(std::size_t v, Plane<Reservoir>& reservoirs) {
    const ViewSurfaces& view = surfaces_[v];
    if (v < spare_reservoirs_.size()) reservoirs = std::move(spare_reservoirs_[v]);
    if (reservoirs.width() != view.width || reservoirs.height() != view.height)
      reservoirs.resize(view.width, view.height);
  }
  static void clear(const image::Rect& rect, Plane<Reservoir>& reservoirs) {
    if (reservoirs.empty()) return;
    for (int y = rect.y; y < rect.y + rect.height; ++y)
      std::fill_n(reservoirs.row(y).begin() + rect.x, rect.width, Reservoir{});
  }
  /// A tile's work: the nodes its cells ask, and what every cell costs.
  std::vector<scheduling::TilePlace> places(std::size_t v, const CutPlan& plan) const {
    std::vector<scheduling::TilePlace> places = surfaces_[v].places(v);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const image::Rect& rect = surfaces_[v].tiles[k].rect;
      for (int y = rect.y; y < rect.y + rect.height; ++y)
        for (int x = rect.x; x < rect.x + rect.width; ++x)
          places[k].work += static_cast<float>(plan.nodes(x, y));
      if (gloss_ == Gloss::Yes) places[k].work += gloss_work(config_, surfaces_[v].tiles[k], plan);
    }
    return places;
  }
  /// What the first view has not found already.
  FrameReport light_rest(const OtherEye& other, std::size_t v, const SurfaceTile& tile,
                         const CutPlan& plan, const KeptView* last, KeptView& kept) {
    const auto begin = std::chrono::steady_clock::now();
    const auto rest = std::make_unique<SurfaceTile>();
    rest->rect = tile.rect;
    rest->points.sample = tile.points.sample, rest->points.keeps_whole = tile.points.keeps_whole;
    for (std::size_t i = 0; i < tile.points.count; ++i) {
      const image::Pixel at = tile.pixel(i);
      if (const std::optional<Rgb> light = other.light(tile, i)) {
        light_(at.x, at.y) = *light;
      } else {
        append(tile, i, *rest);
      }
    }
    const double reproject_ms = units::to_ms(std::chrono::steady_clock::now() - begin);
    FrameReport report = light_tile(v, *rest, plan, last, kept);
    report.reproject_ms = reproject_ms, report.resampled_cells = rest->points.count;
    return report;
  }
  FrameReport light_tile(std::size_t v, const SurfaceTile& tile, const CutPlan& plan,
                         const KeptView* last, KeptView& kept) {
    FrameReport report;
    CutWork work;
    std::vector<Rgb> slots(tile.points.count, Rgb{0.0F});
    add_lights_apart(scene_, tile.points, work.lighting, slots);
    if (reservoirs()) {
      add_reservoir_light(scene_, tile, plan, config_.reservoirs, last, request_.views[v], work,
                          kept.reservoirs, slots);
    } else {
      add_cut_light(scene_, tile, plan, work, slots);
    }
    add_surroundings(scene_, config_.ray, tile.points, work.lighting, slots);
    if (gloss_ == Gloss::Yes) add_gloss(scene_, config_, tile, plan, work.lighting, slots);
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
  void smooth(std::size_t v, scheduling::RowBands& bands, KeptView* last, KeptView& kept) {
    const auto begin = std::chrono::steady_clock::now();
    constexpr float kLeast = 1e-3F;
    const auto scale = [&](const scheduling::Band& rows, const auto& by) {
      for_each_point(surfaces_[v], rows, bands,
                     [&](const SurfaceTile& tile, std::size_t i, const image::Pixel& at) {
                       Rgb& light = light_(at.x, at.y);
                       if (!math::is_finite(light)) light = Rgb{0.0F};
                       light *= by(glm::max(tile.points.reflectors.reflectance[i], Rgb{kLeast}));
                     });
    };
    scale(bands.around(kDenoiseReach),
          [](const Rgb& reflectance) { return Rgb{1.0F} / reflectance; });
    const bool is_known = last != nullptr && last->memory.surfaces.width() > 0;
    const DenoiseJob job{request_.views[v], surfaces_[v], eccentricity_, plan_.cut_nodes[v],
                         is_known ? &last->memory : nullptr};
    report_.stopped |=
        denoise(job, scheduler_, light_, kept.memory) == scheduling::Outcome::Stopped;
    scale(bands.own(), [](const Rgb& reflectance) { return reflectance; });
    report_.post_ms += units::to_ms(std::chrono::steady_clock::now() - begin);
  }

  /// Radiance that is no number becomes black, and is counted.
  void deliver(std::size_t v, scheduling::RowBands& bands) {
    not_finite_.assign(static_cast<std::size_t>(surfaces_[v].height), 0U);
    const auto outcome =
        for_each_point(surfaces_[v], bands.own(), bands,
                       [&](const SurfaceTile&, std::size_t, const image::Pixel& at) {
                         Rgb& radiance = out_.views[v].radiance(at.x, at.y);
                         radiance += light_(at.x, at.y);
                         if (math::is_finite(radiance)) return;
                         radiance = Rgb{0.0F};
                         ++not_finite_[static_cast<std::size_t>(at.y)];
                       });
    report_.stopped |= outcome == scheduling::Outcome::Stopped;
  }
  /// The picture goes to rank 0, which counts.
  void hand_over(std::size_t v, scheduling::RowBands& bands) {
    ViewBuffers& view = out_.views[v];
    const auto outcome = bands.gather(Audience::RankZero, [&](int y, Parcel& parcel) {
      parcel.values(view.radiance.row(y));
      parcel.value(not_finite_[static_cast<std::size_t>(y)]);
    });
    for (const std::uint32_t count : not_finite_) report_.non_finite_samples += count;
    report_.stopped |= outcome == scheduling::Outcome::Stopped;
  }

  void steady(std::size_t v, scheduling::RowBands& bands, KeptView* last, KeptView& kept) {
    const auto begin = std::chrono::steady_clock::now();
    ViewBuffers& view = out_.views[v];
    Plane<float> inverse_depth(view.depth_m.width(), view.depth_m.height());
    const scheduling::Band beside = bands.around(1);
    bands.run(beside, [&](int y) {
      std::ranges::transform(view.depth_m.row(y), inverse_depth.row(y).begin(),
                             [](float depth) { return 1.0F / depth; });
    });
    bands.lend(1, [&](int y, Parcel& parcel) { parcel.values(view.radiance.row(y)); });
    kept.picture.world_from_view = request_.views[v].world_from_view;
    kept.picture.grid = request_.views[v].grid;
    const reconstruction::SteadyConfig settings;
    reconstruction::PictureJoin joined(last != nullptr ? &last->picture : nullptr, settings,
                                       view.radiance, inverse_depth, kept.picture);
    Plane<Rgb> shown(view.radiance.width(), view.radiance.height());
    const auto prepared = bands.run(beside, [&](int y) { joined.prepare_row(y); });
    if (bands.is_shared() && last != nullptr) fetch_picture(joined, bands, last->picture);
    const auto outcome = bands.run(bands.own(), [&](int y) { joined.join_row(y, shown.row(y)); });
    report_.stopped |=
        prepared == scheduling::Outcome::Stopped || outcome == scheduling::Outcome::Stopped;
    view.radiance = std::move(shown);
    report_.post_ms += units::to_ms(std::chrono::steady_clock::now() - begin);
  }

  /// Rows of the last picture that this rank's look up.
  void fetch_picture(reconstruction::PictureJoin& joined, scheduling::RowBands& bands,
                     reconstruction::PictureMemory& last) {
    const scheduling::Band own = bands.own();
    std::vector<scheduling::Rows> reads(static_cast<std::size_t>(own.count()));
    bands.run(own, [&](int y) {
      const auto [first, end] = joined.locate_row(y);
      reads[static_cast<std::size_t>(y - own.begin)] = {first, end};
    });
    scheduling::RowBands then(scheduler_, last.roots.height());
    const auto outcome = then.fetch(reads, [&](int y, Parcel& parcel) {
      parcel.values(last.roots.row(y)), parcel.values(last.frames.row(y));
    });
    report_.stopped |= outcome == scheduling::Outcome::Stopped;
  }

  void keep(std::unique_ptr<LightHistory> kept, LightHistory* last, History& history) {
    for (std::size_t v = 0; v < surfaces_.size(); ++v) {
      kept->views[v].view = request_.views[v];
      if (!reservoirs()) continue;
      kept->views[v].surfaces = std::move(surfaces_[v]);
      if (last == nullptr) continue;
      kept->spare.push_back(std::move(last->views[v].surfaces));
      kept->spare_reservoirs.push_back(std::move(last->views[v].reservoirs));
    }
    if (!reservoirs()) kept->spare = std::move(surfaces_);
    kept->pose.time = scene_.time();
    kept->pose.world_from_object = scene_.pose().world_from_object;
    history.record = std::move(kept);
  }

  const FrameRequest& request_;
  const SceneFrame& scene_;
  const Config& config_;
  TileScheduler& scheduler_;
  FrameBuffers& out_;
  FrameReport report_;
  std::vector<ViewSurfaces> surfaces_;
  std::vector<Plane<Reservoir>> spare_reservoirs_;
  Gloss gloss_ = Gloss::No;
  float lamp_area_m2_ = 0.0F;  ///< with gloss
  LightPlan plan_;
  std::vector<LowPicture> low_;
  Plane<float> eccentricity_;              ///< of the view at work, radians
  Plane<Rgb> first_light_;                 ///< of the first view, before it is smoothed
  Plane<Rgb> light_;                       ///< its light, without what surfaces emit
  std::vector<std::uint32_t> not_finite_;  ///< by its rows
};

}  // namespace

FrameReport render_deferred(const FrameRequest& request, const SceneFrame& scene,
                            const Config& config, History& history, TileScheduler& scheduler,
                            FrameBuffers& out) {
  return Frame(request, scene, config, scheduler, out).run(history);
}

}  // namespace macula::kernels::lightcuts
