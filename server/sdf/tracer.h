// Sphere tracing of a program over the cells of a PixelGrid. Three methods with the same evaluator
// and the same hits: `Full` steps plainly with the whole program; `FullBest` prunes
// the program by block and depth slab and relaxes its steps (Ban and Valasek 2023); `Cones` first
// moves cones around ever smaller groups of cells as far as everything in them is free, with the
// exact step of
//   t* = t cos th + sqrt(d^2 - t^2 sin^2 th),  d the distance at t on the axis, th the half-angle,
// and then does what FullBest does from there.
// A Tracer is immutable and used by many threads at once, each with its own TraceWorkspace; a
// sample's result depends neither on threads nor on the order of tiles. Positions are relative to
// the program's eye, directions in scene orientation, t along unit directions, meters.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "server/sdf/program.h"
#include "shared/base/result.h"
#include "shared/foveation/pixel_grid.h"
#include "shared/image/plane.h"
#include "shared/math/pose.h"

namespace macula::sdf {

enum class Method { Full, FullBest, Cones };

struct TraceOptions {
  Method method = Method::Cones;
  /// Cells a side of the groups that share a cone, descending powers of two up to 32. With
  /// more than one sample a cell's own cone follows by itself.
  std::vector<int> levels{16, 8, 4, 2};
  int samples = 1;  ///< rays a cell, 1..16, at sample_offset(i, samples)
  /// A ray hits where it first comes nearer to the surface than hit_pixels * (half a cell's width
  /// at t) + hit_m, and is moved from there to where it crosses; one that only touches stays.
  /// Whatever the method (march.h says how), and to the bit.
  float hit_pixels = 0.125F;
  float hit_m = 0.0F;
  int max_steps = 4096;  ///< evaluations a ray; then it is Capped
};

enum class RayStatus : std::uint8_t {
  Miss,
  Hit,
  Capped,  ///< t is how far it came
  Inside,  ///< the eye is in a solid: a hit at t = 0
  Broken,  ///< the field was not a number; t is where
};

/// One sample.
struct Hit {
  Vec3 direction{0.0F};  ///< unit
  float t = 0.0F;        ///< +infinity for a Miss
  Vec3 normal{0.0F};     ///< unit, of Hit; towards the eye for Inside; else zero
  std::int32_t material = -1;
  std::uint16_t x = 0, y = 0;  ///< cell of the grid
  std::uint8_t sample = 0;
  RayStatus status = RayStatus::Miss;
  std::uint16_t steps = 0;  ///< evaluations of this ray itself
};

/// What a block of cells made: row by row, a cell's samples in order; unwanted cells are absent.
struct HitBlock {
  image::Rect cells;
  std::vector<Hit> hits;
};

/// Work of a trace; sums over tiles are the same for any thread count.
struct TraceCounts {
  std::uint64_t rays = 0;
  std::uint64_t ray_evaluations = 0;
  std::uint64_t cone_evaluations = 0;
  std::uint64_t surface_evaluations = 0;  ///< to find crossings, and one a hit with gradient
  /// Lane operations of all of these (operations_of; with gradient four times as many).
  std::uint64_t operations = 0;
  std::uint64_t prunings = 0;
  std::uint64_t capped = 0, inside = 0, broken = 0;

  TraceCounts& operator+=(const TraceCounts& other);
  std::uint64_t evaluations() const {
    return ray_evaluations + cone_evaluations + surface_evaluations;
  }
};

/// Blocks are at most this large; a quarter of it with more than two samples a cell.
inline constexpr int kBlockSide = 64;
/// Tiles up to this side share what was pruned for them; a multiple of kBlockSide.
inline constexpr int kTileSide = 128;

/// Where in its cell sample i of n lies, in (0, 1)^2; n = 1 is the centre.
Vec2 sample_offset(int i, int n);

class UnionTree;
struct TraceScratch;
class TraceWorkspace {
 public:
  TraceWorkspace();
  ~TraceWorkspace();
  TraceScratch& scratch() { return *scratch_; }

 private:
  std::unique_ptr<TraceScratch> scratch_;
};

class Tracer {
 public:
  using Done = std::function<void(const HitBlock&)>;

  /// Errors: levels, samples, hit sizes or step limit out of range. `program` and `grid` must
  /// outlive the tracer.
  static Result<Tracer> create(const Program& program, const DMat3& scene_from_view,
                               const PixelGrid& grid, const TraceOptions& options);

  /// Traces the wanted cells of a tile of at most kTileSide cells a side and hands over one block
  /// after the other; a block lives until `done` returns. `mask`, of the grid's size, wants the
  /// cells that are not 0; null wants all.
  TraceCounts trace(const image::Rect& tile, const image::Plane<std::uint8_t>* mask,
                    TraceWorkspace& workspace, const Done& done) const;

 private:
  friend class TileTrace;
  Tracer(const Program& program, const DMat3& scene_from_view, const PixelGrid& grid,
         const TraceOptions& options);

  const Program* program_;
  std::shared_ptr<const UnionTree> tree_;
  const PixelGrid* grid_;
  Mat3 scene_from_view_;
  TraceOptions options_;
};

}  // namespace macula::sdf
