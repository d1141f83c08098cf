// Lanes: rays or cones on their way, and the vector loops that move a chunk of them one evaluation
// on. Inside server/sdf.
//
// **Where a ray hits.** At the first of its marks where the field is below the hit distance,
// width t + hit_m. Marks are places along the ray that depend on nothing but t and the hit
// distance, about as far apart as that, so that no solid lies between two of them unseen. A lane
// passes a mark without looking only where a distance found elsewhere proves that it is not so
// near, roundings allowed for: however lanes get there, they end at the same mark.
#pragma once

#include <cstddef>
#include <cstdint>

#include "server/sdf/evaluate.h"

namespace macula::sdf {

enum class Stepping { Plain, Relaxed, Cone };

enum class LaneState : std::int32_t {
  Live,
  Left,  ///< live, but the next position lies outside the chunk's slab
  Hit,
  Miss,
  Capped,   ///< of a cone: stopped all the same
  Stopped,  ///< a cone came as far as it could
  Inside,
  Broken,
};

/// A page of kBatch lanes, field by field.
struct alignas(64) Chunk {
  float x[kBatch], y[kBatch], z[kBatch];  ///< unit direction
  float at[kBatch];                       ///< where the field is asked next
  float t[kBatch];                        ///< no mark before it is near
  float radius[kBatch];  ///< nor are those from there to t + radius; of a hit the distance at it
  float first[kBatch];   ///< the first mark beyond that
  float slope[kBatch];   ///< how the distance changes along the ray, smoothed
  float width[kBatch];   ///< ray: hit distance at unit t. Cone: sine of the half-angle
  float half[kBatch];    ///< cone: sine of half the half-angle
  std::int32_t steps[kBatch], state[kBatch];
  std::uint32_t id[kBatch];
};

/// What lanes do where nothing is in the way of any of a bundle. Steps show nothing of how bundles
/// were cut; leaps are shorter work.
enum class FreeWay { Step, Leap };

/// Roundings of a distance, relative to the way from the eye to what it was measured to: twice what
/// was seen along rays of the scenes that come with the program and of hard ones.
inline constexpr float kFieldRounding = 2e-6F;

struct MarchLimits {
  float slab_low = 0.0F, slab_high = 0.0F;  ///< positions asked for lie in [low, high)
  float far_m = 0.0F, hit_m = 0.0F;
  float hit_width = 0.0F;  ///< of cones: the widest of the rays in them
  std::int32_t max_steps = 0;
  FreeWay free_way = FreeWay::Step;
};

/// Where unit directions go: planes at a vector's alignment.
struct DirectionPlanes {
  float *x, *y, *z;
};
/// Through points of the tangent plane (frames.h), `scene_from_view` a rotation. All planes are
/// aligned and padded to a multiple of 16 entries.
void directions(const float* tangent_x, const float* tangent_y, std::size_t count,
                const Mat3& scene_from_view, const DirectionPlanes& out);

/// Where the chunk's lanes ask next.
void positions(const Chunk& chunk, std::size_t count, PointBatch& out);
/// Moves the live lanes on by what was found there; returns how many are live (not Left) after it
/// and writes their next positions.
std::size_t advance(Stepping stepping, Chunk& chunk, std::size_t count, const DistanceBatch& found,
                    const MarchLimits& limits, PointBatch& next);

}  // namespace macula::sdf
