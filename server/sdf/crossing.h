// Where rays cross a surface, found from the mark at which they hit and nothing else, so that it
// does not matter how they got there: along the ray by steps of a mark's spacing, twice that, four
// times, to behind the surface, back between the last two, and then on the line between two places
// one spacing apart, above the surface before and below behind it. Inside server/sdf.
#pragma once

#include <cstddef>
#include <cstdint>

#include "server/sdf/evaluate.h"

namespace macula::sdf {

/// How far from its mark a crossing is looked for, relative to t: less than the slabs' margin by
/// more than a mark's spacing.
inline constexpr float kCrossingReach = 3.6e-3F;

enum class CrossingPhase : std::int32_t {
  New,      ///< only direction, mark, width, f_low (the distance at the mark) and id are set
  Ahead,    ///< above the surface at `low`; asked `step` farther on
  Between,  ///< and below it at `high`; asked in the middle, `step` from both
  Behind,   ///< below it at the mark, `high`; asked `step` before
  Found,    ///< `at` is the crossing
  Touch,    ///< no crossing: `at` is the mark
};

/// Up to kBatch rays, field by field.
struct alignas(64) Crossings {
  float x[kBatch], y[kBatch], z[kBatch];  ///< unit direction
  float mark[kBatch], width[kBatch];      ///< where the ray hits; its hit distance at unit t
  float at[kBatch];                       ///< where the field is asked next
  float low[kBatch], high[kBatch];
  float f_low[kBatch], f_high[kBatch];  ///< distances there
  float step[kBatch];
  float least[kBatch];  ///< the spacing of marks at the mark
  std::int32_t phase[kBatch];
  std::uint32_t id[kBatch];
};

/// Where the rays ask next, new ones for the first time.
void aim_crossings(Crossings& rays, std::size_t count, float hit_m, PointBatch& next);
/// Takes the distances there.
void take_crossings(Crossings& rays, std::size_t count, const DistanceBatch& found);

/// Gradients become unit normals; zero where there is none.
void make_normals(SurfaceBatch& surfaces, std::size_t count);

}  // namespace macula::sdf
