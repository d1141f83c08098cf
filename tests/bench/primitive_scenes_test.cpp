#include "tests/bench/primitive_scenes.h"

#include <gtest/gtest.h>

#include "server/kernels/scene_frame.h"

namespace macula::bench {
namespace {

/// Share of a picture of the disc that primitives cover.
double coverage(int count) {
  const auto frame = kernels::SceneFrame::create(primitive_scene(count));
  EXPECT_TRUE(frame);
  constexpr int kSide = 50;
  int met = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const Vec3 at{0.2F * (static_cast<float>(x) - 24.5F), 0.2F * (static_cast<float>(y) - 24.5F),
                    0.0F};
      const Vec3 eye{0.0F, 0.0F, 6.0F};
      met += (*frame)->occluded({eye, at - eye, 0.0F, 10.0F, {}}) ? 1 : 0;
    }
  }
  return met / 2.5e3;
}

TEST(PrimitiveScenes, CoverAboutTheSameWhateverTheirNumber) {
  const double of_ten = coverage(10);
  EXPECT_GT(of_ten, 0.2);
  for (const int count : {1, 100, 1000})
    EXPECT_NEAR(coverage(count), of_ten, 0.2 * of_ten) << count;
}

TEST(PrimitiveScenes, AreNamedByTheirNumber) {
  EXPECT_EQ(primitive_count("primitives-1000"), 1000);
  for (const char* other : {"primitives", "primitives-", "primitives-0", "primitives-1x",
                            "primitives-99999", "temple"}) {
    EXPECT_FALSE(primitive_count(other)) << other;
  }
}

}  // namespace
}  // namespace macula::bench
