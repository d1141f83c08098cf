// Lanes: rays or cones on their way, and the vector loops that move a chunk of them one evaluation
// on. Inside server/sdf.
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

struct Lane {
  float x = 0.0F, y = 0.0F, z = 0.0F;  ///< unit direction
  float at = 0.0F;                     ///< where the field is asked next
  float t = 0.0F;                      ///< free up to here
  float radius = 0.0F;                 ///< the distance found at t
  float slope = -1.0F;                 ///< how the distance changes along the ray, smoothed
  float width = 0.0F;  ///< ray: hit distance at unit t. Cone: sine of the half-angle
  float half = 0.0F;   ///< cone: sine of half the half-angle
  std::int32_t steps = 0;
  LaneState state = LaneState::Live;
  float padding = 0.0F;
};
static_assert(sizeof(Lane) == 48);

/// kBatch lanes, field by field.
struct alignas(64) Chunk {
  float x[kBatch], y[kBatch], z[kBatch];
  float at[kBatch], t[kBatch], radius[kBatch], slope[kBatch], width[kBatch], half[kBatch];
  std::int32_t steps[kBatch], state[kBatch];
  std::uint32_t id[kBatch];

  void load(std::size_t i, const Lane& lane, std::uint32_t lane_id);
  void save(std::size_t i, Lane& lane) const;
  void move(std::size_t from, std::size_t to);
};

struct MarchLimits {
  float slab_low = 0.0F, slab_high = 0.0F;  ///< positions asked for lie in [low, high)
  float far_m = 0.0F, hit_m = 0.0F;
  std::int32_t max_steps = 0;
};

/// Where the chunk's lanes ask next.
void positions(const Chunk& chunk, std::size_t count, PointBatch& out);
/// Moves the live lanes on by what was found there; returns how many are live (not Left) after it
/// and writes their next positions.
std::size_t advance(Stepping stepping, Chunk& chunk, std::size_t count, const DistanceBatch& found,
                    const MarchLimits& limits, PointBatch& next);

}  // namespace macula::sdf
