// How depth is cut: short where something may be met, long where nothing is.
#include "server/sdf/slabs.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

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
    outer_.reset(program_, nullptr, ahead(), Slabs::Pruning::ByDepth);
    inner_.reset(program_, &outer_, ahead(), Slabs::Pruning::ByDepth);
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

}  // namespace
}  // namespace macula::sdf
