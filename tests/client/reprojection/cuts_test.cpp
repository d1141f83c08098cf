#include "client/reprojection/cuts.h"

#include <gtest/gtest.h>

#include "tests/client/reprojection/analytic_scene.h"

namespace macula::reprojection {
namespace {

using namespace test;

/// A frame of one row pattern of inverse depths (1/m), repeated over six rows.
Frame frame_of(const std::vector<float>& inverse_depths, const foveation::Display& display) {
  const PixelGrid all = foveation::make_uniform_grid(display);
  const int width = static_cast<int>(inverse_depths.size());
  PixelGrid grid{{all.x_edges.begin(), all.x_edges.begin() + width + 1},
                 {all.y_edges.begin(), all.y_edges.begin() + 7}};
  Frame frame{{}, grid, image::Plane<Rgb8>(width, 6), image::Plane<float>(width, 6)};
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < width; ++x) frame.inverse_depth(x, y) = inverse_depths[x];
  return frame;
}

/// '-' joined, '|' cut, between neighbouring cells of the row, for an offset of `offset` meters.
std::string joints(const std::vector<float>& inverse_depths, double offset) {
  const auto display = square_display(200);  // 173 px per unit tangent
  const Frame frame = frame_of(inverse_depths, display);
  const SourceView view = frame.view();
  const RelativeView relative{DMat3(1.0), {offset, 0, 0}};
  const MeshProjector mesh(view, relative, display);
  const Cuts cuts(mesh, relative, display, 0.75F);
  std::string text;
  for (int i = 0; i + 1 < frame.color.width(); ++i) text += cuts.joined_right(i + 1, 3) ? '-' : '|';
  return text;
}

TEST(Cuts, FollowTheParallaxOfTheActualOffset) {
  // A step from 1/m to 0.5/m parts by 0.5 * 173 * offset pixels.
  EXPECT_EQ(joints({1, 1, 1, 0.5F, 0.5F, 0.5F}, 0.0), "-----");
  EXPECT_EQ(joints({1, 1, 1, 0.5F, 0.5F, 0.5F}, 0.008), "-----");  // 0.69 px
  EXPECT_EQ(joints({1, 1, 1, 0.5F, 0.5F, 0.5F}, 0.009), "--|--");  // 0.78 px
  EXPECT_EQ(joints({1, 1, 1, 0, 0, 0}, 0.05), "--|--");            // sky
}

TEST(Cuts, SpareSteepPlanesAndTheFoldsBetweenThem) {
  EXPECT_EQ(joints({1, 1.5F, 2, 2.5F, 3, 3.5F}, 0.1), "-----");
  EXPECT_EQ(joints({1, 1.5F, 2, 2, 2, 2}, 0.1), "-----");
  EXPECT_EQ(joints({1, 1.5F, 2, 1.5F, 1, 0.5F}, 0.1), "-----");
}

TEST(Cuts, PartAThinPostFromBothSides) {
  EXPECT_EQ(joints({0.5F, 0.5F, 2, 0.5F, 0.5F, 0.5F}, 0.1), "-||--");
  EXPECT_EQ(joints({0.5F, 0.5F, 2, 2, 0.5F, 0.5F}, 0.1), "-|-|-");
}

TEST(Cuts, ACutQuadKeepsEachCornersQuarterAtItsOwnDepth) {
  // Seen without parallax in x, the two halves of a cut quad meet in its middle.
  const auto display = square_display(200);
  const Frame frame = frame_of({2, 2, 0.5F, 0.5F}, display);
  const SourceView view = frame.view();
  const RelativeView sideways{DMat3(1.0), {0.1, 0, 0}};
  const MeshProjector looks(view, {DMat3(1.0), {0, 0, 0}}, display);
  const Cuts cuts(looks, sideways, display, 0.75F);
  Fragments out(200, 200);
  for (int row = 1; row < 6; ++row)
    for (int column = 1; column < 4; ++column) {
      const auto splat = WarpOptions::Silhouettes::Splat;
      EXPECT_EQ(draw_cut_quad(looks, cuts, column, row, splat, out), column == 2);
    }
  EXPECT_FALSE(out.drawn(0, 2));  // what hangs together is left to others
  EXPECT_FALSE(out.drawn(3, 2));
  for (int x = 1; x < 3; ++x) {
    const Fragment f = out(x, 2);
    EXPECT_NEAR(f.inverse_depth, x < 2 ? 2.0F : 0.5F, 1e-5F) << x;
    EXPECT_NEAR(f.u, static_cast<float>(x), 1e-3F);
    EXPECT_NEAR(f.v, 2.0F, 1e-3F);
  }
}

}  // namespace
}  // namespace macula::reprojection
