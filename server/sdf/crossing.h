// Where rays cross a surface, found so that it does not matter where a ray came from: the ray's
// way is cut into cells of 256 float steps, and the point is where the line between a cell's ends,
// above the surface before and below behind it, meets it. Methods that stop at different places
// near a surface then hit the same bits. Inside server/sdf.
#pragma once

#include <cstddef>
#include <cstdint>

#include "server/sdf/evaluate.h"

namespace macula::sdf {

/// Float steps of a cell, a power of two: some times as wide as the field's roundings, which are a
/// few steps, and about as wide as what is called near enough (2e-5 of t).
inline constexpr std::uint32_t kCellSteps = 256;
/// How far from where a ray stopped its crossing is looked for, relative to t: less than the
/// slabs' margin by more than a cell.
inline constexpr float kCrossingReach = 3.6e-3F;

enum class CrossingState : std::int32_t {
  Open,   ///< `at` is where to look next
  Found,  ///< `at` is the crossing
};

/// Up to kBatch rays, field by field.
struct alignas(64) Crossings {
  float x[kBatch], y[kBatch], z[kBatch];  ///< unit direction
  float at[kBatch], found[kBatch];        ///< a place on the ray and the distance there
  float slope[kBatch];                    ///< how the distance changes along the ray about there
  float low[kBatch], high[kBatch];        ///< the cell to look at
  std::int32_t state[kBatch];
};

/// The cell in which the line through `at` crosses; its ends as points.
void choose_cells(Crossings& rays, std::size_t count, PointBatch& low, PointBatch& high);
/// Takes the distances at the ends; `at`, `found` and `slope` become those of the crossing or of
/// the cell, and `state` says which.
void cross_cells(Crossings& rays, std::size_t count, const DistanceBatch& low,
                 const DistanceBatch& high);

/// Gradients become unit normals; zero where there is none.
void make_normals(SurfaceBatch& surfaces, std::size_t count);

}  // namespace macula::sdf
