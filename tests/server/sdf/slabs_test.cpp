// How depth is cut: short where something may be met, long where nothing is.
#include "server/sdf/slabs.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "server/sdf/lane_march.h"
#include "tests/server/sdf/tracing.h"

namespace macula::sdf {
namespace {

/// A narrow cone about the view axis.
Cone ahead() {
  return cone_around(std::array{Vec3{0.0F, 0.0F, -1.0F}, glm::normalize(Vec3{0.02F, 0.0F, -1.0F})});
}

class FreeWays : public testing::Test {
 protected:
  void SetUp() override {
    outer_.reset({program_}, ahead());
    inner_.reset_within(outer_, ahead());
  }

  Program program_ =
      compile(scene_of(R"({"type": "sphere", "radius": 1, "at": [0, 0, -3]})"), 0.0, DVec3{0.0});
  Registers registers_;
  Slabs outer_, inner_;
};

TEST_F(FreeWays, AreOneSlabAnOctave) {
  for (Slabs* slabs : {&outer_, &inner_}) {
    Slab& behind = slabs->of(9.0F, registers_);
    EXPECT_EQ(behind.low, 8.0F);
    EXPECT_EQ(behind.high, 16.0F);
    EXPECT_EQ(&slabs->of(8.0F, registers_), &behind);
    EXPECT_EQ(&slabs->of(15.9F, registers_), &behind);
    EXPECT_NE(&slabs->of(16.0F, registers_), &behind);
  }
}

TEST_F(FreeWays, EndWhereSomethingMayBeMet) {
  for (Slabs* slabs : {&outer_, &inner_}) {
    for (const float t : {2.0F, 2.5F, 3.9F}) {
      const Slab& slab = slabs->of(t, registers_);
      EXPECT_LE(slab.low, t);
      EXPECT_GT(slab.high, t);
      EXPECT_LT(slab.high - slab.low, 0.3F);
    }
  }
}

TEST_F(FreeWays, LeaveNoGapAndNoOverlap) {
  float end = 0.0F;
  while (end < 64.0F) {
    const Slab& slab = inner_.of(end, registers_);
    ASSERT_EQ(slab.low, end);
    ASSERT_GT(slab.high, end);
    ASSERT_EQ(&inner_.of(std::nextafter(slab.high, 0.0F), registers_), &slab);
    end = slab.high;
  }
}

// ---- leaps ----

/// A wall a centimeter thick at z = -3, looked at through a cone along -z.
class Wall : public testing::Test {
 protected:
  void SetUp() override {
    scratch_.tile_slabs.reset({program_}, ahead());
    scratch_.block_slabs.reset_within(scratch_.tile_slabs, ahead());
    scratch_.results.resize(1);
    limits_.far_m = program_.far_m, limits_.hit_m = 1e-3F, limits_.max_steps = 1000;
    limits_.free_way = FreeWay::Leap;
  }
  /// A ray that is asked next at `at` and free until radius beyond t.
  LaneResult march_from(float t, float radius, float at) {
    Chunk lane{};
    lane.z[0] = -1.0F;
    lane.t[0] = t, lane.radius[0] = radius, lane.slope[0] = -0.5F, lane.at[0] = at;
    scratch_.block_slabs.of(at, scratch_.registers).waiting.push(lane, 0, scratch_.pool);
    evaluations_ = march(Stepping::Relaxed, limits_, scratch_).evaluations;
    return scratch_.results[0];
  }

  Program program_ = compile(
      scene_of(R"({"type": "box", "half_size": [5, 5, 0.005], "at": [0, 0, -3]})"), 0.0, DVec3{});
  TraceScratch scratch_;
  MarchLimits limits_;
  std::uint64_t evaluations_ = 0;
};

TEST_F(Wall, IsLeftBehindWithoutAnEvaluation) {
  const LaneResult result = march_from(8.0F, 0.0F, 8.0F);
  EXPECT_EQ(result.state, LaneState::Miss);
  EXPECT_EQ(evaluations_, 0U);
}

/// Rays were lost behind thin things: a stretched step had led them into a free way, and they went
/// on from there before anybody had looked at what it led across.
TEST_F(Wall, IsMetByARayWhoseStretchedStepLedAcrossIt) {
  const LaneResult result = march_from(2.0F, 0.5F, 8.0F);
  EXPECT_EQ(result.state, LaneState::Hit);
  EXPECT_NEAR(result.at, 2.995F, 2e-3F);
}

}  // namespace
}  // namespace macula::sdf
