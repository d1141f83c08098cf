#include "server/kernels/sphere/passes.h"

#include <cmath>
#include <limits>
#include <vector>

#include "server/kernels/parcels.h"
#include "server/kernels/sphere/detail.h"
#include "server/kernels/sphere/edges.h"
#include "server/kernels/sphere/fill.h"
#include "server/kernels/sphere/hit_shader.h"
#include "server/kernels/sphere/levels.h"
#include "server/kernels/sphere/mask.h"
#include "server/sdf/paper_pyramid.h"
#include "shared/base/check.h"

namespace macula::kernels::sphere {
namespace {

using scheduling::Outcome;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// The sample that speaks for a cell in planes which cannot be averaged: the one nearest its
/// middle.
int guide_of(int samples) {
  const auto off = [&](int i) { return glm::length(sdf::sample_offset(i, samples) - 0.5F); };
  int best = 0;
  for (int i = 1; i < samples; ++i)
    if (off(i) < off(best)) best = i;
  return best;
}

/// View depth where the plane through a hit meets the ray through its cell's middle; a plane too
/// edge-on to be followed (a factor of 2 in depth) keeps the hit's own.
float central_depth(const ViewContext& context, const PixelGrid& grid, const ShadedHit& shaded) {
  const sdf::Hit& hit = shaded.hit;
  const Vec3 own = hit.direction / glm::dot(hit.direction, context.forward);
  const Vec3 central = Mat3(context.scene_from_view) * grid.ray(hit.x, hit.y);
  const float ratio = glm::dot(hit.normal, own) / glm::dot(hit.normal, central);
  return ratio > 0.5F && ratio < 2.0F ? shaded.depth_m * ratio : shaded.depth_m;
}

/// Sums a cell's samples, which come one after the other.
class CellSum {
 public:
  void add(const ShadedHit& shaded) {
    if (shaded.hit.sample == 0) *this = CellSum{};
    radiance_ += shaded.radiance;
    const float luminance = image::luminance(shaded.radiance);
    luminance_ += luminance, square_ += luminance * luminance;
    steps_ += shaded.hit.steps;
  }
  Rgb mean(int n) const { return radiance_ / static_cast<float>(n); }
  float steps(int n) const { return static_cast<float>(steps_) / static_cast<float>(n); }
  /// Of the mean luminance; +infinity for a single sample.
  float variance(int n) const {
    if (n < 2) return kInfinity;
    const float count = static_cast<float>(n), mean = luminance_ / count;
    return std::max(square_ / count - mean * mean, 0.0F) / (count - 1.0F);
  }

 private:
  Rgb radiance_{0.0F};
  float luminance_ = 0.0F, square_ = 0.0F;
  int steps_ = 0;
};

/// Writes finished cells into the view's planes.
class CellWriter {
 public:
  CellWriter(const ViewContext& context, const PixelGrid& grid, int samples, ViewBuffers& out)
      : context_(context), grid_(grid), samples_(samples), guide_(guide_of(samples)), out_(out) {}

  void operator()(const ShadedHit& shaded) {
    const sdf::Hit& hit = shaded.hit;
    sum_.add(shaded);
    if (hit.sample == guide_) write_guide(shaded);
    if (hit.sample + 1 == samples_) write_means(hit.x, hit.y);
  }

 private:
  void write_guide(const ShadedHit& shaded) {
    const sdf::Hit& hit = shaded.hit;
    const bool met = met_surface(hit);
    out_.depth_m(hit.x, hit.y) =
        met && samples_ > 1 ? central_depth(context_, grid_, shaded) : shaded.depth_m;
    if (context_.wanted & kSurfaceId)
      out_.surface_id(hit.x, hit.y) = met ? static_cast<std::uint32_t>(hit.material) + 1U : 0U;
    if (context_.wanted & kNormal) out_.normal(hit.x, hit.y) = met ? hit.normal : Vec3{0.0F};
    if (context_.wanted & kAlbedo) out_.albedo(hit.x, hit.y) = shaded.albedo;
  }
  void write_means(int x, int y) {
    out_.radiance(x, y) = sum_.mean(samples_);
    if (context_.wanted & kSteps) out_.steps(x, y) = sum_.steps(samples_);
    if (context_.wanted & kVariance) out_.variance(x, y) = sum_.variance(samples_);
    if (context_.wanted & kSamples) out_.samples(x, y) = static_cast<float>(samples_);
  }

  const ViewContext& context_;
  const PixelGrid& grid_;
  int samples_, guide_;
  CellSum sum_;
  ViewBuffers& out_;
};

/// Writes cells of the middle level.
class MidWriter {
 public:
  MidWriter(unsigned wanted, int samples, MidLevel& mid)
      : wanted_(wanted), samples_(samples), guide_(guide_of(samples)), mid_(mid) {}

  void operator()(const ShadedHit& shaded) {
    const sdf::Hit& hit = shaded.hit;
    sum_.add(shaded);
    if (hit.sample == guide_) write_guide(shaded);
    if (hit.sample + 1 == samples_) {
      mid_.radiance(hit.x, hit.y) = sum_.mean(samples_);
      mid_.steps(hit.x, hit.y) = sum_.steps(samples_);
      mid_.age(hit.x, hit.y) = 0;
    }
  }

 private:
  void write_guide(const ShadedHit& shaded) {
    const sdf::Hit& hit = shaded.hit;
    const bool met = met_surface(hit);
    mid_.inverse_depth(hit.x, hit.y) = met ? inverse_of_depth(shaded.depth_m) : 0.0F;
    if (wanted_ & kSurfaceId)
      mid_.surface_id(hit.x, hit.y) = met ? static_cast<std::uint32_t>(hit.material) + 1U : 0U;
    if (wanted_ & kNormal) mid_.normal(hit.x, hit.y) = met ? hit.normal : Vec3{0.0F};
    if (wanted_ & kAlbedo) mid_.albedo(hit.x, hit.y) = shaded.albedo;
  }

  unsigned wanted_;
  int samples_, guide_;
  CellSum sum_;
  MidLevel& mid_;
};

/// Tiles of a grid, in the order of a picture.
std::vector<image::Rect> tiles_of(const PixelGrid& grid, int side) {
  std::vector<image::Rect> tiles;
  for (int y = 0; y < grid.height(); y += side)
    for (int x = 0; x < grid.width(); x += side)
      tiles.push_back({x, y, std::min(side, grid.width() - x), std::min(side, grid.height() - y)});
  return tiles;
}

/// A tile's work: the cells that are traced, and a few for what all tiles do.
std::vector<scheduling::TilePlace> places_of(const std::vector<image::Rect>& tiles,
                                             const PixelGrid& grid,
                                             const Plane<std::uint8_t>* mask) {
  std::vector<scheduling::TilePlace> places;
  for (const image::Rect& tile : tiles) {
    places.push_back(scheduling::place_of(tile, grid.width(), grid.height()));
    if (mask == nullptr) continue;
    int cells = 16;
    for (int y = tile.y; y < tile.y + tile.height; ++y)
      for (int x = tile.x; x < tile.x + tile.width; ++x) cells += (*mask)(x, y) != 0;
    places.back().work = static_cast<float>(cells);
  }
  return places;
}

FrameReport report_of(const sdf::TraceCounts& counts, const ShadeWork& shading) {
  FrameReport report;
  report.primary_rays = counts.rays;
  report.shadow_rays = shading.shadow_rays;
  report.field_evaluations = counts.evaluations() + shading.field_evaluations;
  report.field_operations = counts.operations + shading.field_operations;
  report.non_finite_samples = shading.non_finite;
  report.unfinished_rays = counts.capped + counts.broken;
  return report;
}

/// Of the tiles that ranks share: about as many on a coarse level as on a fine one, and small
/// enough that ranks finish together.
int shared_side(const PixelGrid& grid) {
  constexpr int kAcross = 16, kLeastSide = 16;
  int side = sdf::kBlockSide;
  while (side > kLeastSide && grid.width() < kAcross * side) side /= 2;
  return side;
}

class ViewRun {
 public:
  ViewRun(const ViewContext& context, TileScheduler& scheduler, ViewBuffers& out)
      : context_(context), scheduler_(scheduler), out_(out) {}

  FrameReport run(const ViewHistory* last, ViewHistory& now) {
    const bool thin =
        context_.config.foveation == Foveation::On && may_thin(context_.view, context_.config.mask);
    if (thin) {
      foveated(last, now);
    } else if (context_.config.tracing == Tracing::PaperPyramid) {
      trace_paper_pyramid();
    } else {
      trace_cells(context_.config.samples_per_cell, nullptr, Audience::RankZero);
    }
    return report_;
  }

 private:
  void foveated(const ViewHistory* last, ViewHistory& now);
  LowLevel trace_low(const PixelGrid& low_grid);
  void trace_mid(const PixelGrid& mid_grid, MidLevel& mid);
  void trace_cells(int samples, const Plane<std::uint8_t>* mask, Audience audience);
  void trace_detail(MidLevel& mid, Plane<std::uint8_t>& finished);

  void trace_paper_pyramid();

  /// Every tile of a grid: `begin()` makes what takes one tile's blocks, `trace_tile(tile,
  /// workspace, done)` hands them over.
  /// `outputs(tile, parcel)`: what its blocks are written to; nullptr: every rank runs all tiles.
  template <class Begin, class Tile, class Outputs>
  void run_tiles(const PixelGrid& grid, const Plane<std::uint8_t>* mask, Audience audience,
                 Begin begin, Tile trace_tile, Outputs outputs);
  template <class Begin, class Outputs>
  void trace(const PixelGrid& grid, int samples, int side, const Plane<std::uint8_t>* mask,
             Audience audience, Begin begin, Outputs outputs);
  /// Of the view's grid; all of them without a mask.
  auto cells_written(const Plane<std::uint8_t>* mask = nullptr) {
    return [this, mask](const image::Rect& tile, Parcel& parcel) {
      if (mask == nullptr) return kernels::carry(out_, tile, parcel);
      kernels::carry(out_, scheduling::marked_cells(*mask, tile, 1), parcel);
    };
  }

  const ViewContext& context_;
  TileScheduler& scheduler_;
  ViewBuffers& out_;
  WorkspacePool pool_;
  FrameReport report_;
};

template <class Begin, class Tile, class Outputs>
void ViewRun::run_tiles(const PixelGrid& grid, const Plane<std::uint8_t>* mask, Audience audience,
                        Begin begin, Tile trace_tile, Outputs outputs) {
  if (report_.stopped) return;
  const std::vector<image::Rect> tiles =
      tiles_of(grid, scheduler_.sharing() == nullptr ? sdf::kTileSide : shared_side(grid));
  std::vector<sdf::TraceCounts> counts(tiles.size());
  std::vector<ShadeWork> shading(tiles.size());
  const auto run_tile = [&](std::size_t i) {
    WorkspacePool::Loan workspace(pool_);
    auto take = begin();
    counts[i] = trace_tile(tiles[i], *workspace, std::ref(take));
    shading[i] = take.work();
  };
  Outcome outcome = Outcome::Completed;
  if constexpr (std::is_null_pointer_v<Outputs>) {
    outcome = scheduler_.run(tiles.size(), run_tile);
  } else {
    outcome = scheduling::run_shared(
        scheduler_, tiles.size(), audience, [&] { return places_of(tiles, grid, mask); }, run_tile,
        [&](std::size_t i, Parcel& parcel) {
          parcel.value(counts[i]), parcel.value(shading[i]);
          outputs(tiles[i], parcel);
        });
  }
  sdf::TraceCounts sum;
  for (const sdf::TraceCounts& part : counts) sum += part;
  ShadeWork shaded;
  for (const ShadeWork& part : shading) shaded += part;
  report_ += report_of(sum, shaded);
  report_.stopped = report_.stopped || outcome == Outcome::Stopped;
}

template <class Begin, class Outputs>
void ViewRun::trace(const PixelGrid& grid, int samples, int side, const Plane<std::uint8_t>* mask,
                    Audience audience, Begin begin, Outputs outputs) {
  const sdf::Tracer tracer = make_tracer(context_, grid, samples, side);
  run_tiles(
      grid, mask, audience, begin,
      [&](const image::Rect& tile, sdf::TraceWorkspace& workspace, auto done) {
        return tracer.trace(tile, mask, workspace, done);
      },
      outputs);
}

/// Shades blocks and passes their samples on to a writer.
template <class Writer>
class ShadeInto {
 public:
  ShadeInto(const ViewContext& context, const PixelGrid& grid, int samples, Writer writer)
      : shader_(context, grid, samples), writer_(writer) {}

  void operator()(const sdf::HitBlock& block) { shader_.shade(block, std::ref(writer_)); }
  ShadeWork work() const { return shader_.work(); }

 private:
  HitShader shader_;
  Writer writer_;
};

void ViewRun::trace_cells(int samples, const Plane<std::uint8_t>* mask, Audience audience) {
  const PixelGrid& grid = context_.view.grid;
  trace(
      grid, samples, 1, mask, audience,
      [&] { return ShadeInto(context_, grid, samples, CellWriter(context_, grid, samples, out_)); },
      cells_written(mask));
}

/// Takes nothing: levels that only guide the next.
struct Guide {
  void operator()(const sdf::HitBlock&) const {}
  static ShadeWork work() { return {}; }
};

void ViewRun::trace_paper_pyramid() {
  const int n = context_.config.samples_per_cell;
  sdf::PaperOptions options;
  options.samples = n;
  const PixelGrid& grid = context_.view.grid;
  auto pyramid =
      sdf::PaperPyramid::create(context_.program, context_.scene_from_view, grid, options);
  MACULA_CHECK(pyramid.has_value(), "a kernel's options are checked when it is made");
  constexpr int kLast = sdf::PaperPyramid::kLevels - 1;
  const auto level = [&](int number) {
    return [&pyramid, number](const image::Rect& tile, sdf::TraceWorkspace& workspace, auto done) {
      return pyramid->trace(number, tile, workspace, done);
    };
  };
  for (int guide = 0; guide < kLast; ++guide)
    run_tiles(
        pyramid->grid(guide), nullptr, Audience::EveryRank, [] { return Guide{}; }, level(guide),
        nullptr);
  run_tiles(
      grid, nullptr, Audience::RankZero,
      [&] { return ShadeInto(context_, grid, n, CellWriter(context_, grid, n, out_)); },
      level(kLast), cells_written());
}

/// All that a MidWriter writes, where the mask says so.
void carry(MidLevel& mid, const image::Rect& tile, const Plane<std::uint8_t>& mask,
           Parcel& parcel) {
  const auto cells = scheduling::marked_cells(mask, tile, 1);
  const auto written = [&](auto& plane) { parcel.cells(plane, cells); };
  written(mid.radiance), written(mid.inverse_depth), written(mid.age), written(mid.surface_id);
  written(mid.normal), written(mid.albedo), written(mid.steps);
}

void ViewRun::trace_mid(const PixelGrid& mid_grid, MidLevel& mid) {
  Plane<std::uint8_t> wanted(mid.source.width(), mid.source.height(), 0);
  for (std::size_t i = 0; i < wanted.size(); ++i)
    wanted.pixels()[i] = mid.source.pixels()[i] == MidSource::Traced ? 1 : 0;
  const int n = context_.config.block_samples;
  trace(
      mid_grid, n, kMidSide, &wanted, Audience::EveryRank,
      [&] { return ShadeInto(context_, mid_grid, n, MidWriter(context_.wanted, n, mid)); },
      [&](const image::Rect& tile, Parcel& parcel) { carry(mid, tile, wanted, parcel); });
}

/// Traces the cells where the middle level shows detail and adds them to `finished`.
void ViewRun::trace_detail(MidLevel& mid, Plane<std::uint8_t>& finished) {
  const Config& config = context_.config;
  const Detail detail = find_detail(mid, finished, context_.view.tone, config.detail, scheduler_);
  trace_cells(config.block_samples, &detail.cells, Audience::EveryRank);
  if (report_.stopped) return;
  for (std::size_t i = 0; i < finished.size(); ++i)
    finished.pixels()[i] |= detail.cells.pixels()[i];
  for (std::size_t i = 0; i < mid.source.size(); ++i)
    if (detail.blocks.pixels()[i] != 0) mid.source.pixels()[i] = MidSource::Average;
  average_important(out_, context_.wanted, scheduler_, mid);
}

/// Depths of the low level, which need no light.
class LowDepths {
 public:
  LowDepths(const ViewContext& context, LowLevel& low) : context_(context), low_(low) {}

  void operator()(const sdf::HitBlock& block) {
    for (const sdf::Hit& hit : block.hits) {
      const bool met = met_surface(hit);
      const float depth = hit.t * glm::dot(hit.direction, context_.forward);
      low_.inverse_depth(hit.x, hit.y) = met && depth > 0.0F ? 1.0F / depth : 0.0F;
      low_.distance(hit.x, hit.y) = met ? hit.t : kInfinity;
    }
  }
  static ShadeWork work() { return {}; }

 private:
  const ViewContext& context_;
  LowLevel& low_;
};

/// The same with what the eye would see there.
class LowColors {
 public:
  LowColors(const ViewContext& context, const PixelGrid& grid, LowLevel& low)
      : context_(context), depths_(context, low), shader_(context, grid, 1), low_(low) {}

  void operator()(const sdf::HitBlock& block) {
    depths_(block);
    const bool albedo = context_.config.mask.edges == EdgeSource::Albedo;
    shader_.shade(block, [&](const ShadedHit& shaded) {
      const Rgb seen =
          albedo ? shaded.albedo : image::display_linear(context_.view.tone, shaded.radiance);
      low_.luminance(shaded.hit.x, shaded.hit.y) = image::srgb_from_linear(image::luminance(seen));
    });
  }
  ShadeWork work() const { return shader_.work(); }

 private:
  const ViewContext& context_;
  LowDepths depths_;
  HitShader shader_;
  LowLevel& low_;
};

LowLevel ViewRun::trace_low(const PixelGrid& low_grid) {
  LowLevel low;
  low.inverse_depth = Plane<float>(low_grid.width(), low_grid.height(), 0.0F);
  low.distance = low.inverse_depth;
  const auto outputs = [&](const image::Rect& tile, Parcel& parcel) {
    parcel.rect(low.inverse_depth, tile), parcel.rect(low.distance, tile);
    parcel.rect(low.luminance, tile);
  };
  if (context_.config.mask.edges == EdgeSource::Depth) {
    trace(
        low_grid, 1, kLowSide, nullptr, Audience::EveryRank,
        [&] { return LowDepths(context_, low); }, outputs);
  } else {
    low.luminance = low.inverse_depth;
    trace(
        low_grid, 1, kLowSide, nullptr, Audience::EveryRank,
        [&] { return LowColors(context_, low_grid, low); }, outputs);
  }
  return low;
}

void ViewRun::foveated(const ViewHistory* last, ViewHistory& now) {
  const View& view = context_.view;
  const Config& config = context_.config;
  const PixelGrid low_grid = coarsen(view.grid, kLowSide);
  now.world_from_view = view.world_from_view;
  now.mid_grid = coarsen(view.grid, kMidSide);
  now.frame = context_.frame;
  MidLevel& mid = now.mid;
  mid.resize(now.mid_grid.width(), now.mid_grid.height());

  const LowLevel low = trace_low(low_grid);
  if (report_.stopped) return;
  const Plane<float> edges = find_edges(low, low_grid, config.mask);
  const Plane<std::uint8_t> important =
      important_cells(view, edges, context_.frame, context_.seed, config.mask, scheduler_);
  mid.source = mid_sources(important);
  if (last != nullptr) {
    // Where surfaces end, whatever the mask calls an edge: the literal filter fires all over a
    // floor.
    MaskConfig corrected = config.mask;
    corrected.rule = MaskRule::Corrected;
    const bool as_masked = config.mask.rule == MaskRule::Corrected;
    const Plane<float> ends = as_masked ? edges : find_edges(low, low_grid, corrected);
    keep({view, now.mid_grid, low, ends, context_.frame, config}, *last, scheduler_, mid);
  }
  trace_mid(now.mid_grid, mid);
  trace_cells(config.samples_per_cell, &important, Audience::EveryRank);
  if (report_.stopped) return;
  average_important(out_, context_.wanted, scheduler_, mid);
  Plane<std::uint8_t> finished = important;
  if (std::isfinite(config.detail)) trace_detail(mid, finished);
  if (report_.stopped) return;
  scheduling::RowBands bands(scheduler_, view.grid.height());
  fill_unimportant(view.grid, now.mid_grid, finished, mid, context_.wanted, bands, out_);
  const bool softened = config.transition == Transition::Gaussian;
  if (softened) soften_transitions(important, bands, out_.radiance);
  const auto outcome = bands.gather(Audience::RankZero, [&](int y, Parcel& parcel) {
    const image::Rect row{0, y, view.grid.width(), 1};
    if (softened) return kernels::carry(out_, row, parcel);
    kernels::carry(out_, scheduling::marked_cells(finished, row, 0), parcel);  // it has the others
  });
  report_.stopped = report_.stopped || outcome == Outcome::Stopped;
}

}  // namespace

FrameReport render_view(const ViewContext& context, const ViewHistory* last,
                        TileScheduler& scheduler, ViewBuffers& out, ViewHistory& now) {
  return ViewRun(context, scheduler, out).run(last, now);
}

}  // namespace macula::kernels::sphere
