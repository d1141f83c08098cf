#include "server/sdf/tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/sdf/lane_march.h"
#include "server/sdf/scratch.h"
#include "shared/base/check.h"
#include "shared/base/text.h"

namespace macula::sdf {
namespace {

constexpr int kMaxSamples = 16;

bool is_level(int side) {
  return side >= 1 && side <= kBlockSide && (side & (side - 1)) == 0;
}

/// i's bits mirrored at the point, in base 2.
float radical_inverse(int i) {
  float result = 0.0F, place = 0.5F;
  for (; i > 0; i >>= 1, place *= 0.5F) result += place * static_cast<float>(i & 1);
  return result;
}

}  // namespace

Vec2 sample_offset(int i, int n) {
  if (n == 1) return {0.5F, 0.5F};
  const float cell = 0.5F / static_cast<float>(n);
  return {(static_cast<float>(i) + 0.5F) / static_cast<float>(n), radical_inverse(i) + cell};
}

TraceCounts& TraceCounts::operator+=(const TraceCounts& other) {
  rays += other.rays;
  ray_evaluations += other.ray_evaluations;
  cone_evaluations += other.cone_evaluations;
  surface_evaluations += other.surface_evaluations;
  operations += other.operations;
  prunings += other.prunings;
  capped += other.capped, inside += other.inside, broken += other.broken;
  return *this;
}

TraceWorkspace::TraceWorkspace() : scratch_(std::make_unique<TraceScratch>()) {}
TraceWorkspace::~TraceWorkspace() = default;

/// One tile on one thread.
class TileTrace {
 public:
  TileTrace(const Tracer& tracer, const image::Plane<std::uint8_t>* mask, TraceScratch& scratch)
      : grid_(*tracer.grid_),
        program_(*tracer.program_),
        options_(tracer.options_),
        scene_from_view_(tracer.scene_from_view_),
        mask_(mask),
        s_(scratch) {
    limits_.far_m = program_.far_m;
    limits_.hit_m = options_.hit_m;
    limits_.max_steps = options_.max_steps;
  }

  TraceCounts run(const image::Rect& tile, const Tracer::Done& done) {
    if (prunes()) s_.tile_slabs.reset(program_, nullptr, cone_of(tile), Slabs::Pruning::ByDepth);
    for (int y = 0; y < tile.height; y += kBlockSide) {
      for (int x = 0; x < tile.width; x += kBlockSide) {
        block_ = {tile.x + x, tile.y + y, std::min(kBlockSide, tile.width - x),
                  std::min(kBlockSide, tile.height - y)};
        if (take_wanted()) trace_block(done);
      }
    }
    if (prunes()) counts_.prunings += s_.tile_slabs.prunings();
    return counts_;
  }

 private:
  bool prunes() const { return options_.method != Method::Full; }

  Vec3 direction(const Vec2& tangent) const {
    return glm::normalize(scene_from_view_ * math::direction_from_tangent(tangent));
  }
  Vec3 corner_direction(int x, int y) const {
    return direction(
        {grid_.x_edges[static_cast<std::size_t>(x)], grid_.y_edges[static_cast<std::size_t>(y)]});
  }
  /// A cone's section by the tangent plane is convex: what holds the corners holds the rectangle.
  Cone cone_of(const image::Rect& cells) const {
    const int right = cells.x + cells.width, bottom = cells.y + cells.height;
    const Vec3 corners[4] = {corner_direction(cells.x, cells.y), corner_direction(right, cells.y),
                             corner_direction(cells.x, bottom), corner_direction(right, bottom)};
    return cone_around(corners);
  }

  bool take_wanted() {
    s_.wanted.assign(static_cast<std::size_t>(block_.width * block_.height), 1);
    if (!mask_) return true;
    bool any = false;
    for (int y = 0; y < block_.height; ++y) {
      for (int x = 0; x < block_.width; ++x) {
        const bool wanted = (*mask_)(block_.x + x, block_.y + y) != 0;
        s_.wanted[static_cast<std::size_t>(y * block_.width + x)] = wanted;
        any = any || wanted;
      }
    }
    return any;
  }
  bool wanted(int x, int y) const {
    return s_.wanted[static_cast<std::size_t>(y * block_.width + x)] != 0;
  }

  void trace_block(const Tracer::Done& done) {
    const auto pruning = prunes() ? Slabs::Pruning::ByDepth : Slabs::Pruning::None;
    s_.block_slabs.reset(program_, prunes() ? &s_.tile_slabs : nullptr, cone_of(block_), pruning);
    start_side_ = 0;
    if (options_.method == Method::Cones) march_cones();
    make_rays();
    march(prunes() ? Stepping::Relaxed : Stepping::Plain, limits_, s_, counts_.ray_evaluations,
          counts_.operations);
    take_results();
    find_surfaces(limits_.hit_m, s_, s_.block.hits, counts_);
    if (prunes()) counts_.prunings += s_.block_slabs.prunings();
    s_.block.cells = block_;
    done(s_.block);
  }

  // ---- cones ----

  void march_cones() {
    for (const int side : options_.levels) {
      if (side > 1 || options_.samples == 1) march_level(side);
    }
    if (options_.samples > 1) march_level(1);
  }

  void march_level(int side) {
    const int columns = (block_.width + side - 1) / side, rows = (block_.height + side - 1) / side;
    s_.inner.assign(static_cast<std::size_t>(columns * rows), ConeCell{});
    s_.lanes.clear();
    s_.cells.clear();
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) add_cone(side, column, row, columns);
    }
    march(Stepping::Cone, limits_, s_, counts_.cone_evaluations, counts_.operations);
    for (std::size_t i = 0; i < s_.lanes.size(); ++i) {
      ConeCell& cell = s_.inner[s_.cells[i]];
      cell.start = s_.lanes[i].at;
      cell.open = s_.lanes[i].state != LaneState::Miss;
    }
    std::swap(s_.inner, s_.outer);
    start_side_ = side;
  }

  void add_cone(int side, int column, int row, int columns) {
    const image::Rect cells{column * side, row * side, std::min(side, block_.width - column * side),
                            std::min(side, block_.height - row * side)};
    const ConeCell from = start_of(cells.x, cells.y);
    if (!from.open || !any_wanted(cells)) return;
    const Cone cone = cone_of({block_.x + cells.x, block_.y + cells.y, cells.width, cells.height});
    Lane lane;
    lane.x = cone.axis.x, lane.y = cone.axis.y, lane.z = cone.axis.z;
    lane.at = from.start;
    lane.width = cone.sine();
    lane.half = cone.half;
    s_.lanes.push_back(lane);
    s_.cells.push_back(static_cast<std::uint32_t>(row * columns + column));
  }
  bool any_wanted(const image::Rect& cells) const {
    if (!mask_) return true;
    for (int y = 0; y < cells.height; ++y) {
      for (int x = 0; x < cells.width; ++x) {
        if (wanted(cells.x + x, cells.y + y)) return true;
      }
    }
    return false;
  }
  /// What the level before says of the cell (x, y) of the block.
  ConeCell start_of(int x, int y) const {
    if (start_side_ == 0) return {0.0F, true};
    const int columns = (block_.width + start_side_ - 1) / start_side_;
    return s_.outer[static_cast<std::size_t>(y / start_side_ * columns + x / start_side_)];
  }

  // ---- rays ----

  void make_rays() {
    s_.lanes.clear();
    s_.block.hits.clear();
    for (int y = 0; y < block_.height; ++y) {
      for (int x = 0; x < block_.width; ++x) {
        if (wanted(x, y)) add_rays(x, y);
      }
    }
    counts_.rays += s_.lanes.size();
  }
  void add_rays(int x, int y) {
    const ConeCell from = start_of(x, y);
    const int column = block_.x + x, row = block_.y + y;
    const Vec2 size = grid_.footprint(column, row);
    for (int i = 0; i < options_.samples; ++i) {
      const Vec2 at = sample_offset(i, options_.samples);
      const Vec2 tangent = grid_.tangent(column, row, at.x, at.y);
      Hit& hit = s_.block.hits.emplace_back();
      hit.direction = direction(tangent);
      hit.x = static_cast<std::uint16_t>(column), hit.y = static_cast<std::uint16_t>(row);
      hit.sample = static_cast<std::uint8_t>(i);
      Lane& lane = s_.lanes.emplace_back();
      lane.x = hit.direction.x, lane.y = hit.direction.y, lane.z = hit.direction.z;
      lane.at = lane.t = from.open ? from.start : limits_.far_m;
      const float square = 1.0F + tangent.x * tangent.x + tangent.y * tangent.y;
      lane.width = options_.hit_pixels * 0.5F * std::min(size.x, size.y) / square;
      if (!from.open) lane.state = LaneState::Miss;
    }
  }

  void take_results() {
    for (std::size_t i = 0; i < s_.lanes.size(); ++i) {
      const Lane& lane = s_.lanes[i];
      Hit& hit = s_.block.hits[i];
      hit.steps = static_cast<std::uint16_t>(lane.steps);
      hit.t = lane.at;
      hit.status = status_of(lane.state);
      if (hit.status == RayStatus::Miss) hit.t = std::numeric_limits<float>::infinity();
      if (hit.status == RayStatus::Inside) hit.normal = -hit.direction;
      counts_.capped += hit.status == RayStatus::Capped;
      counts_.inside += hit.status == RayStatus::Inside;
      counts_.broken += hit.status == RayStatus::Broken;
    }
  }
  static RayStatus status_of(LaneState state) {
    switch (state) {
      case LaneState::Hit:
        return RayStatus::Hit;
      case LaneState::Miss:
        return RayStatus::Miss;
      case LaneState::Inside:
        return RayStatus::Inside;
      case LaneState::Broken:
        return RayStatus::Broken;
      default:
        return RayStatus::Capped;
    }
  }

  const PixelGrid& grid_;
  const Program& program_;
  const TraceOptions& options_;
  const Mat3& scene_from_view_;
  const image::Plane<std::uint8_t>* mask_;
  TraceScratch& s_;
  MarchLimits limits_;
  image::Rect block_;
  int start_side_ = 0;  ///< of the level in s_.outer; 0: no level yet
  TraceCounts counts_;
};

Tracer::Tracer(const Program& program, const DMat3& scene_from_view, const PixelGrid& grid,
               const TraceOptions& options)
    : program_(&program), grid_(&grid), scene_from_view_(scene_from_view), options_(options) {}

Result<Tracer> Tracer::create(const Program& program, const DMat3& scene_from_view,
                              const PixelGrid& grid, const TraceOptions& options) {
  MACULA_CHECK(foveation::is_valid(grid), "a tracer needs a valid grid");
  for (std::size_t i = 0; i < options.levels.size(); ++i) {
    if (!is_level(options.levels[i]) || (i > 0 && options.levels[i] >= options.levels[i - 1])) {
      return base::bad_input("levels are not descending powers of two", "levels",
                             base::concat("1 to ", kBlockSide));
    }
  }
  if (options.samples < 1 || options.samples > kMaxSamples)
    return base::bad_input("samples out of range", "samples", base::concat("1 to ", kMaxSamples));
  const bool sizes = options.hit_pixels >= 0.0F && options.hit_pixels <= 10.0F &&
                     options.hit_m >= 0.0F && options.hit_pixels + options.hit_m > 0.0F;
  if (!sizes) {
    return base::bad_input("no hit distance", "hit_pixels, hit_m",
                           "at least one above 0, hit_pixels up to 10");
  }
  if (options.max_steps < 1 || options.max_steps > 65535)
    return base::bad_input("step limit out of range", "max_steps", "1 to 65535");
  return Tracer(program, scene_from_view, grid, options);
}

TraceCounts Tracer::trace(const image::Rect& tile, const image::Plane<std::uint8_t>* mask,
                          TraceWorkspace& workspace, const Done& done) const {
  MACULA_CHECK(tile.x >= 0 && tile.y >= 0 && tile.width > 0 && tile.height > 0 &&
               tile.width <= kTileSide && tile.height <= kTileSide &&
               tile.x + tile.width <= grid_->width() && tile.y + tile.height <= grid_->height());
  MACULA_CHECK(!mask || (mask->width() == grid_->width() && mask->height() == grid_->height()));
  return TileTrace(*this, mask, workspace.scratch()).run(tile, done);
}

}  // namespace macula::sdf
