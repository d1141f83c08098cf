#include "server/sdf/tracer.h"

#include <algorithm>
#include <cmath>

#include "server/sdf/ray_block.h"
#include "server/sdf/surfaces.h"
#include "server/sdf/union_tree.h"
#include "shared/base/check.h"
#include "shared/base/text.h"

namespace macula::sdf {
namespace {

constexpr int kMaxSamples = 16;
constexpr int kMaxLevel = 32;
constexpr int kLeastBlockSide = 16;
/// A block should span no more than about this, from its axis to its corner.
constexpr float kBlockAngle = 0.04F;  // rad

bool is_level(int side) {
  return side >= 1 && side <= kMaxLevel && (side & (side - 1)) == 0;
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
        tree_(*tracer.tree_),
        options_(tracer.options_),
        scene_from_view_(tracer.scene_from_view_),
        mask_(mask),
        s_(scratch) {
    limits_.far_m = program_.far_m;
    limits_.hit_m = options_.hit_m;
    limits_.max_steps = options_.max_steps;
    if (options_.method == Method::Cones) limits_.free_way = FreeWay::Leap;
  }

  TraceCounts run(const image::Rect& tile, const Tracer::Done& done) {
    limits_.hit_width = hit_width(tile);
    if (prunes())
      s_.tile_slabs.reset({program_, &tree_, limits_.hit_width, options_.hit_m}, cone_of(tile));
    const int side = block_side(tile);
    for (int y = 0; y < tile.height; y += side) {
      for (int x = 0; x < tile.width; x += side) {
        block_ = {tile.x + x, tile.y + y, std::min(side, tile.width - x),
                  std::min(side, tile.height - y)};
        if (take_wanted()) trace_block(done);
      }
    }
    if (prunes()) counts_.prunings += s_.tile_slabs.prunings();
    return counts_;
  }

 private:
  /// Blocks narrow enough to see little of the scene, yet with enough rays to share what is pruned.
  int block_side(const image::Rect& tile) const {
    int side = options_.samples > 2 ? kBlockSide / 2 : kBlockSide;
    if (!prunes()) return side;
    const float cell =
        2.0F * cone_of(tile).half / static_cast<float>(std::max(tile.width, tile.height));
    while (side > kLeastBlockSide && cell * static_cast<float>(side) > kBlockAngle) side /= 2;
    return side;
  }
  bool prunes() const { return options_.method != Method::Full; }
  /// The most that a ray of the tile calls near, at unit t: aim_rays' for cells in the middle.
  float hit_width(const image::Rect& tile) const {
    float widest = 0.0F, highest = 0.0F;
    for (int x = tile.x; x < tile.x + tile.width; ++x)
      widest = std::max(widest, grid_.footprint(x, tile.y).x);
    for (int y = tile.y; y < tile.y + tile.height; ++y)
      highest = std::max(highest, grid_.footprint(tile.x, y).y);
    return std::min(options_.hit_pixels * 0.5F * std::max(widest, highest), kMostHitWidth);
  }

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
    if (prunes()) s_.block_slabs.reset_within(s_.tile_slabs, cone_of(block_));
    if (!prunes()) s_.block_slabs.reset_whole(program_);
    start_side_ = 0;
    if (options_.method == Method::Cones) march_cones();
    make_rays();
    count(march(prunes() ? Stepping::Relaxed : Stepping::Plain, limits_, s_),
          counts_.ray_evaluations);
    take_results(s_, counts_);
    count(find_surfaces(limits_, s_, s_.block.hits), counts_.surface_evaluations);
    if (prunes()) counts_.prunings += s_.block_slabs.prunings();
    s_.block.cells = block_;
    done(s_.block);
  }
  void count(const MarchWork& work, std::uint64_t& evaluations) {
    evaluations += work.evaluations;
    counts_.operations += work.operations;
  }

  // ---- cones ----

  void march_cones() {
    make_corners();
    for (const int side : options_.levels) {
      if (side > 1 || options_.samples == 1) march_level(side);
    }
    if (options_.samples > 1) march_level(1);
  }

  void make_corners() {
    const auto columns = static_cast<std::size_t>(block_.width) + 1;
    const std::size_t corners = columns * (static_cast<std::size_t>(block_.height) + 1);
    s_.corners.resize(corners);
    const auto left = static_cast<std::size_t>(block_.x), top = static_cast<std::size_t>(block_.y);
    for (std::size_t i = 0; i < corners; ++i) {
      s_.corners.tangent_x[i] = grid_.x_edges[left + i % columns];
      s_.corners.tangent_y[i] = grid_.y_edges[top + i / columns];
    }
    s_.corners.point_along(corners, scene_from_view_);
  }

  void march_level(int side) {
    const int columns = (block_.width + side - 1) / side, rows = (block_.height + side - 1) / side;
    s_.inner.assign(static_cast<std::size_t>(columns * rows), ConeCell{});
    s_.results.resize(std::max(s_.results.size(), s_.inner.size()));
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column)
        add_cone(side, column, row, static_cast<std::uint32_t>(row * columns + column));
    }
    count(march(Stepping::Cone, limits_, s_), counts_.cone_evaluations);
    for (std::size_t i = 0; i < s_.inner.size(); ++i) {
      ConeCell& cell = s_.inner[i];
      if (!cell.open) continue;
      cell.start = s_.results[i].at;
      cell.open = s_.results[i].state != LaneState::Miss;
    }
    std::swap(s_.inner, s_.outer);
    start_side_ = side;
  }

  void add_cone(int side, int column, int row, std::uint32_t id) {
    const int x = column * side, y = row * side;
    const int right = std::min(x + side, block_.width), bottom = std::min(y + side, block_.height);
    const ConeCell from = start_of(x, y);
    if (!from.open || !any_wanted({x, y, right - x, bottom - y})) return;
    const auto corner = [this](int i, int j) {
      return s_.corners[static_cast<std::size_t>(j * (block_.width + 1) + i)];
    };
    const Vec3 corners[4] = {corner(x, y), corner(right, y), corner(x, bottom),
                             corner(right, bottom)};
    const Cone cone = cone_around(corners);
    s_.inner[id].open = true;
    s_.block_slabs.of(from.start, s_.registers)
        .waiting.push(cone.axis, from.start, cone.sine(), cone.half, id, s_.pool);
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

  /// The rays of a cell start where its cone stopped. Cells of one cone that lie side by side send
  /// theirs together.
  void make_rays() {
    const std::size_t rays =
        aim_rays({grid_, scene_from_view_, block_, options_.samples, options_.hit_pixels}, s_);
    const auto samples = static_cast<std::size_t>(options_.samples);
    ConeCell from = start_of(0, 0);
    std::size_t first = 0;
    const auto send_until = [&](std::size_t end) {
      if (from.open) send_rays(first, end - first, from.start, s_);
      if (!from.open) drop_rays(first, end - first, s_);
      first = end;
    };
    for (std::size_t i = 0; start_side_ > 0 && i < rays; i += samples) {
      const Hit& hit = s_.block.hits[i];
      const ConeCell next = start_of(hit.x - block_.x, hit.y - block_.y);
      if (next.open == from.open && next.start == from.start) continue;
      send_until(i);
      from = next;
    }
    send_until(rays);
    counts_.rays += rays;
  }

  const PixelGrid& grid_;
  const Program& program_;
  const UnionTree& tree_;
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
    : program_(&program),
      tree_(std::make_shared<const UnionTree>(program)),
      grid_(&grid),
      scene_from_view_(scene_from_view),
      options_(options) {}

Result<Tracer> Tracer::create(const Program& program, const DMat3& scene_from_view,
                              const PixelGrid& grid, const TraceOptions& options) {
  MACULA_CHECK(foveation::is_valid(grid), "a tracer needs a valid grid");
  const auto is_finite = [](float constant) { return std::isfinite(constant); };
  if (!std::all_of(program.constants.begin(), program.constants.end(), is_finite) ||
      !math::is_finite(program.eye)) {
    return base::bad_input("the field holds a number that is not finite", "field",
                           "finite parameters, lights and cameras at every time");
  }
  for (std::size_t i = 0; i < options.levels.size(); ++i) {
    if (!is_level(options.levels[i]) || (i > 0 && options.levels[i] >= options.levels[i - 1])) {
      return base::bad_input("levels are not descending powers of two", "levels",
                             base::concat("1 to ", kMaxLevel));
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
