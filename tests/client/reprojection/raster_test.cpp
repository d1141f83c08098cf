#include "client/reprojection/raster.h"

#include <gtest/gtest.h>

#include <limits>

#include "shared/math/hash.h"

namespace macula::reprojection {
namespace {

int drawn_count(const Fragments& fragments) {
  int count = 0;
  for (int y = 0; y < fragments.height(); ++y)
    for (int x = 0; x < fragments.width(); ++x) count += fragments.drawn(x, y) ? 1 : 0;
  return count;
}

TEST(Raster, InterpolatesEveryAttributeAffinely) {
  Fragments out(20, 20);
  // value = 0.1 + 0.02 x + 0.03 y; u = x / 2; v = y / 4.
  const auto at = [](float x, float y) {
    return Vertex{x, y, 0.1F + 0.02F * x + 0.03F * y, 0.5F * x, 0.25F * y};
  };
  draw_triangle(at(-3.3F, -2.1F), at(40.7F, 1.2F), at(2.2F, 51.9F), out);
  ASSERT_GT(drawn_count(out), 300);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      if (!out(x, y).drawn()) continue;
      const float fx = static_cast<float>(x), fy = static_cast<float>(y);
      EXPECT_NEAR(out(x, y).inverse_depth, 0.1F + 0.02F * fx + 0.03F * fy, 1e-5F);
      EXPECT_NEAR(out(x, y).u, 0.5F * fx, 1e-4F);
      EXPECT_NEAR(out(x, y).v, 0.25F * fy, 1e-4F);
    }
  }
}

TEST(Raster, TheNearerTriangleWinsInEitherOrder) {
  const auto draw = [](float depth, Fragments& out) {
    draw_triangle({-10, -10, depth, depth, 0}, {30, -10, depth, depth, 0},
                  {-10, 30, depth, depth, 0}, out);
  };
  Fragments a(5, 5), b(5, 5);
  draw(0.5F, a), draw(2.0F, a);
  draw(2.0F, b), draw(0.5F, b);
  EXPECT_EQ(a(2, 2).u, 2.0F);
  EXPECT_EQ(b(2, 2).u, 2.0F);
}

TEST(Raster, InfinityIsDrawnAndAnythingNearerCoversIt) {
  Fragments out(3, 3);
  draw_triangle({-5, -5, 0, 1, 0}, {9, -5, 0, 1, 0}, {-5, 9, 0, 1, 0}, out);
  EXPECT_EQ(drawn_count(out), 9);
  draw_triangle({-5, -5, 1e-6F, 2, 0}, {9, -5, 1e-6F, 2, 0}, {-5, 9, 1e-6F, 2, 0}, out);
  EXPECT_EQ(out(1, 1).u, 2.0F);
}

TEST(Raster, BackFacesEmptyAndNanTrianglesAreLeftOut) {
  Fragments out(8, 8);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  draw_triangle({0, 0, 1, 0, 0}, {0, 7, 1, 0, 0}, {7, 0, 1, 0, 0}, out);    // from behind
  draw_triangle({0, 0, 1, 0, 0}, {3, 3, 1, 0, 0}, {7, 7, 1, 0, 0}, out);    // a line
  draw_triangle({0, 0, 1, 0, 0}, {nan, 0, 1, 0, 0}, {0, 7, 1, 0, 0}, out);  // not in front
  EXPECT_EQ(drawn_count(out), 0);
}

TEST(Raster, AJitteredMeshLeavesNoCracks) {
  // 40 x 40 vertices over 30 x 30 pixels, each moved at random by up to a third of its spacing.
  constexpr int kSide = 41;
  Fragments out(30, 30);
  const auto vertex = [](int i, int j) {
    const auto h = math::hash_mix(static_cast<std::uint64_t>(i * kSide + j));
    const float jx = math::unit_float(h) - 0.5F, jy = math::unit_float(math::hash_mix(h)) - 0.5F;
    const float x = (static_cast<float>(i) + 0.66F * jx) * 0.8F - 1.0F;
    const float y = (static_cast<float>(j) + 0.66F * jy) * 0.8F - 1.0F;
    return Vertex{x, y, 1.0F, 0.0F, 0.0F};
  };
  for (int j = 0; j + 1 < kSide; ++j) {
    for (int i = 0; i + 1 < kSide; ++i) {
      draw_triangle(vertex(i, j), vertex(i + 1, j), vertex(i, j + 1), out);
      draw_triangle(vertex(i + 1, j + 1), vertex(i, j + 1), vertex(i + 1, j), out);
    }
  }
  EXPECT_EQ(drawn_count(out), 900);
}

}  // namespace
}  // namespace macula::reprojection
