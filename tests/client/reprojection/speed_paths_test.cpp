// The ways of drawing that are there for speed, held to the plain ones: vectors against scalars,
// blocks against single cells, every instruction set against every other.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "client/reprojection/doubled_colors.h"
#include "client/reprojection/doubled_rows.h"
#include "client/reprojection/mesh.h"
#include "client/reprojection/raster.h"
#include "hwy/targets.h"
#include "shared/math/hash.h"
#include "tests/client/reprojection/analytic_scene.h"

namespace macula::reprojection {
namespace {

using namespace test;

/// A ball 1 m away before a slanted wall: curved, flat and cut places.
Sight ball_before_wall(const DVec3& origin, const DVec3& direction) {
  const DVec3 to_center = DVec3{0.1, 0.05, -1.2} - origin;
  const double a = glm::dot(direction, direction), b = glm::dot(direction, to_center);
  const double c = glm::dot(to_center, to_center) - 0.09;
  if (const double d = b * b - a * c; d > 0.0 && b > 0.0) {
    const double t = (b - std::sqrt(d)) / a;
    const DVec3 p = origin + t * direction;
    return {t, waves(p.x, p.y, 6.0)};
  }
  return textured_plane(glm::normalize(DVec3{0.3, 0.1, 1.0}), -2.5, 3.0)(origin, direction);
}

const Pose kMoved{{0.02, -0.01, 0.015}, turn({1, 2, 0.5}, Degrees{3})};

/// Columns of one pixel that widen by 2 % each beyond the middle third.
PixelGrid widening_grid(const foveation::Display& display) {
  PixelGrid grid;
  const auto edges = [](double reach, double step) {
    std::vector<float> made{0.0F};
    for (double width = step, at = 0.0; at<1.3 * reach; width *= at> reach / 3.0 ? 1.02 : 1.0) {
      at += width;
      made.push_back(static_cast<float>(at));
      made.insert(made.begin(), static_cast<float>(-at));
    }
    return made;
  };
  const DVec2 reach = display.fov.tangent_max(), step = display.pixel_tangent();
  grid.x_edges = edges(reach.x, step.x), grid.y_edges = edges(reach.y, step.y);
  return grid;
}

TEST(SpeedPaths, BlocksShowWhatSingleCellsShow) {
  const auto display = square_display(300);
  for (const PixelGrid& grid : {grid_with_margin(display, 40), widening_grid(display)}) {
    const Frame frame = draw(ball_before_wall, grid, {}, 2);
    image::Plane<Rgb8> cells, blocks, coarse;
    warp(frame.view(), kMoved, display, {.detail_px = 0.0F}, cells);
    const auto report = warp(frame.view(), kMoved, display, {}, blocks);
    EXPECT_GT(report.filled_px, 100U);
    const auto everywhere = [](int, int) { return true; };
    EXPECT_GT(psnr_db(cells, blocks, everywhere), 62.0);
    warp(frame.view(), kMoved, display, {.detail_px = WarpOptions::kGridDetail_px}, coarse);
    EXPECT_GT(psnr_db(cells, coarse, everywhere), 50.0);
    // The twin that must fail: blocks that may be four pixels off.
    warp(frame.view(), kMoved, display, {.detail_px = 4.0F}, coarse);
    EXPECT_LT(psnr_db(cells, coarse, everywhere), 50.0);
  }
}

TEST(SpeedPaths, EveryInstructionSetGivesTheSameBits) {
  const auto display = square_display(150);
  const Frame frame = draw(ball_before_wall, widening_grid(display), {}, 1);
  for (const WarpOptions& options :
       {WarpOptions{}, WarpOptions{.detail_px = 0.0F},
        WarpOptions{.filter = WarpOptions::Filter::Bilinear}, WarpOptions::grid_mode()}) {
    image::Plane<Rgb8> best;
    int targets = 0;
    for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1, ++targets) {
      hwy::SetSupportedTargetsForTest(rest & -rest);
      image::Plane<Rgb8> shown;
      warp(frame.view(), kMoved, display, options, shown);
      hwy::SetSupportedTargetsForTest(0);
      if (best.empty()) best = shown;
      EXPECT_EQ(psnr_db(best, shown, [](int, int) { return true; }), kInfinity);
    }
    EXPECT_GE(targets, 2);
  }
}

TEST(SpeedPaths, EverySecondPixelShowsNearlyWhatEveryPixelShows) {
  const auto display = square_display(300);
  const Frame frame = draw(ball_before_wall, grid_with_margin(display, 40), {}, 2);
  const auto everywhere = [](int, int) { return true; };
  const WarpOptions each{.filter = WarpOptions::Filter::Bilinear};
  WarpOptions second = each;
  second.raster = WarpOptions::Raster::EverySecond;
  image::Plane<Rgb8> by_each, by_second;
  image::Plane<Coverage> coverage;
  const auto expected = warp(frame.view(), kMoved, display, each, by_each);
  const auto report = warp(frame.view(), kMoved, display, second, by_second, &coverage);
  EXPECT_GT(psnr_db(by_each, by_second, everywhere), 35.0);
  EXPECT_NEAR(report.filled_share(), expected.filled_share(), 0.002);
  const auto filled =
      std::count(coverage.pixels().begin(), coverage.pixels().end(), Coverage::Filled);
  EXPECT_EQ(static_cast<std::uint64_t>(filled), report.filled_px);
  // The twin that must fail: half the pixels, doubled without a look at what lies between.
  const foveation::Display coarse{display.fov, 150, 150};
  image::Plane<Rgb8> half, doubled(300, 300);
  warp(frame.view(), kMoved, coarse, each, half);
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 300; ++x) doubled(x, y) = half(x / 2, y / 2);
  }
  EXPECT_LT(psnr_db(by_each, doubled, everywhere), 35.0);
}

TEST(SpeedPaths, EverySecondPixelOfAnOddDisplayIsEveryPixel) {
  const auto display = square_display(151);
  const Frame frame = draw(ball_before_wall, grid_with_margin(display, 20), {}, 1);
  image::Plane<Rgb8> each, second;
  warp(frame.view(), kMoved, display, {}, each);
  warp(frame.view(), kMoved, display, {.raster = WarpOptions::Raster::EverySecond}, second);
  EXPECT_EQ(psnr_db(each, second, [](int, int) { return true; }), kInfinity);
}

/// A square of them, all 1 m away; place(x, y) in the source, cells.
template <class Place>
Fragments fragments_of(int side, const Place& place) {
  Fragments fragments(side, side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const Vec2 at = place(static_cast<float>(x), static_cast<float>(y));
      fragments.set(x, y, {1.0F, at.x, at.y});
    }
  }
  return fragments;
}

TEST(SpeedPaths, PlacesBetweenFragmentsAreInterpolatedButForSilhouettes) {
  constexpr int kSide = 40, kJump = 20;
  Fragments fragments = fragments_of(kSide, [](float x, float y) {
    const float beyond = x < kJump ? 0.0F : 30.0F;  // cells: another surface
    return Vec2{2.0F * x + beyond, 2.0F * y};
  });
  fragments.set(5, 5, {});
  DoubledRows rows;
  for (int y = 1; y + 1 < 2 * kSide; ++y) {
    const FragmentRow row = rows.row(fragments, y, 0, kSide);
    for (int x = 1; x + 1 < 2 * kSide; ++x) {
      const bool drawn = x / 2 != 5 || y / 2 != 5;
      ASSERT_EQ(row.inverse_depth[x] >= 0.0F, drawn) << x << ", " << y;
      const bool by_hole = std::abs(x - 10.5) < 2.0 && std::abs(y - 10.5) < 2.0;
      const bool by_jump = x == 2 * kJump - 1 || x == 2 * kJump;
      if (by_hole) continue;
      const float beyond = x < 2 * kJump ? 0.0F : 30.0F;
      const float nearest = 2.0F * static_cast<float>(x / 2);
      ASSERT_EQ(row.u[x], (by_jump ? nearest : static_cast<float>(x) - 0.5F) + beyond) << x;
      ASSERT_EQ(row.v[x], static_cast<float>(y) - 0.5F) << y;
    }
  }
}

/// Cells of four pixels: red grows by eight levels a cell, sideways, green by four, downwards.
struct Ramp {
  static constexpr int kCells = 32;
  foveation::Display display = square_display(4 * kCells);
  PixelGrid grid = grid_with_margin(square_display(kCells), 0);
  image::Plane<Rgb8> color{kCells, kCells};
  image::Plane<float> inverse_depth{kCells, kCells, 1.0F};
  Ramp() {
    for (int y = 0; y < kCells; ++y) {
      for (int x = 0; x < kCells; ++x) {
        color(x, y) = {static_cast<std::uint8_t>(8 * x), static_cast<std::uint8_t>(4 * y), 77};
      }
    }
  }
  SourceView view() const { return {{}, grid, color, inverse_depth}; }
};

TEST(SpeedPaths, ColoursBetweenFragmentsAreInterpolatedButForSilhouettes) {
  constexpr int kSide = 40, kJump = 20;
  const Ramp ramp;
  const SourceView source = ramp.view();
  const Resolver resolver(source, ramp.display, WarpOptions::Filter::Bilinear);
  Fragments fragments = fragments_of(kSide, [](float x, float y) {
    const float beyond = x < kJump ? 1.0F : 11.0F;  // cells: another surface
    return Vec2{0.5F * x + beyond, 0.5F * y};
  });
  fragments.set(5, 5, {});
  DoubledColors colors;
  colors.begin(kSide);
  std::vector<Rgb8> row(2 * kSide);
  for (int y = 0; y < 2 * kSide; ++y) {
    colors.draw(fragments, resolver, y, 0, kSide, row);
    for (int x = 1; x + 1 < 2 * kSide; ++x) {
      const bool drawn = x / 2 != 5 || y / 2 != 5;
      ASSERT_TRUE(drawn || row[x] == Rgb8{}) << x << ", " << y;
      const bool by_hole = std::abs(x - 10.5) < 2.0 && std::abs(y - 10.5) < 2.0;
      if (by_hole || y == 0 || y + 1 == 2 * kSide) continue;
      const bool by_jump = x == 2 * kJump - 1 || x == 2 * kJump;
      const double beyond = x < 2 * kJump ? 1.0 : 11.0;
      const double u = (by_jump ? 0.5 * (x / 2) : 0.25 * x - 0.125) + beyond;
      ASSERT_NEAR(row[x].r, 8.0 * u, 1.0) << x << ", " << y;
      ASSERT_NEAR(row[x].g, y - 0.5, 1.0) << x << ", " << y;
      ASSERT_EQ(row[x].b, 77) << x << ", " << y;
    }
  }
}

// What is drawn of a row's middle is what is drawn of the whole row there.
TEST(SpeedPaths, APartOfARowOfColoursIsThatOfTheWholeRow) {
  constexpr int kSide = 40;
  const Ramp ramp;
  const SourceView source = ramp.view();
  const Resolver resolver(source, ramp.display, WarpOptions::Filter::Bilinear);
  Fragments fragments = fragments_of(kSide, [](float x, float y) {
    return Vec2{0.7F * x, 0.6F * y};
  });
  DoubledColors whole, parts;
  whole.begin(kSide), parts.begin(kSide);
  for (int y = 0; y < 2 * kSide; ++y) {
    std::vector<Rgb8> one(2 * kSide), other(2 * kSide);
    whole.draw(fragments, resolver, y, 0, kSide, one);
    parts.draw(fragments, resolver, y, 0, 16, other);
    parts.draw(fragments, resolver, y, 16, kSide, other);
    ASSERT_EQ(one, other) << y;
  }
}

// In grid mode, pixels made of cells that are at most two of them wide come from their own places:
// fine stripes stay what they are; the twin, as if all cells were wide, loses them.
TEST(SpeedPaths, WhereCellsAreNarrowEachPixelHasItsOwnPlace) {
  const auto display = square_display(120);
  const auto stripes = [](const DVec3& origin, const DVec3& direction) {
    const double t = (-1.0 - origin.z) / direction.z;
    return Sight{t, waves(origin.x + t * direction.x, 0.0, 25.0)};
  };
  const Frame frame = draw(stripes, grid_with_margin(display, 10), {}, 4);
  const WarpOptions each{.filter = WarpOptions::Filter::Bilinear};
  WarpOptions second = each;
  second.raster = WarpOptions::Raster::EverySecond;
  image::Plane<Rgb8> by_each, by_second;
  warp(frame.view(), {}, display, each, by_each);
  warp(frame.view(), {}, display, second, by_second);
  const auto everywhere = [](int, int) { return true; };
  EXPECT_GT(psnr_db(by_each, by_second, everywhere), 40.0);
  const SourceView source = frame.view();
  const Resolver resolver(source, display, WarpOptions::Filter::Bilinear);
  image::Plane<Rgb8> smooth(120, 120);
  const Fragments fragments = fragments_of(60, [](float x, float y) {
    return Vec2{2.0F * x + 10.5F, 2.0F * y + 10.5F};
  });
  DoubledColors colors;
  colors.begin(60);
  for (int y = 0; y < 120; ++y) colors.draw(fragments, resolver, y, 0, 60, smooth.row(y));
  EXPECT_LT(psnr_db(by_each, smooth, everywhere), 30.0);
}

TEST(SpeedPaths, AWarperThatKeepsItsMemoryShowsWhatANewOneShows) {
  Warper kept;
  image::Plane<Rgb8> first, again, fresh;
  const auto large = square_display(200), small = square_display(90);
  const Frame one = draw(ball_before_wall, grid_with_margin(large, 20), {});
  const Frame two = draw(ball_before_wall, grid_with_margin(small, 5), {});
  kept.warp(one.view(), kMoved, large, {}, first);
  kept.warp(two.view(), kMoved, small, {}, again);
  warp(two.view(), kMoved, small, {}, fresh);
  EXPECT_EQ(psnr_db(again, fresh, [](int, int) { return true; }), kInfinity);
}

TEST(SpeedPaths, APatchIsProjectedAsItsVerticesAre) {
  const auto display = square_display(64);
  const Frame frame = draw(ball_before_wall, widening_grid(display), {});
  const SourceView view = frame.view();
  const RelativeView relative = relative_view({}, kMoved, WarpOptions::Method::Mesh);
  const MeshProjector mesh(view, relative, display);
  Patch patch;
  for (const auto& [column, row] : {std::pair{0, 0}, {1, 1}, {20, 17}, {mesh.columns() - 2, 30}}) {
    const int cells = column == 0 || column == mesh.columns() - 2 ? 1 : 31;
    mesh.load(column, row, cells, 5, patch);
    project_patch(mesh.projection(), patch);
    for (int j = 0; j <= 5; ++j) {
      for (int i = 0; i <= cells; ++i) {
        const float depth = mesh.inverse_depth(column + i, row + j);
        const Vertex expected =
            mesh.project(mesh.x_tangents()[column + i], mesh.y_tangents()[row + j], depth);
        const std::size_t at = Patch::at(i, j);
        ASSERT_EQ(patch.source_inverse[at], depth) << i << ", " << j;
        ASSERT_EQ(patch.x[at], expected.x);
        ASSERT_EQ(patch.y[at], expected.y);
        ASSERT_EQ(patch.inverse_depth[at], expected.inverse_depth);
      }
    }
  }
}

TEST(SpeedPaths, ManyCellsAtATimeAreDrawnAsOneByOne) {
  // Vertices moved at random, so that cells overlap, turn away and lie between pixels.
  Patch patch;
  patch.column = 5, patch.row = 9, patch.columns = 31, patch.rows = 31;
  const auto random = [](std::size_t i, std::uint64_t what) {
    return math::unit_float(math::hash_mix(i * 7 + what));
  };
  for (int row = 0; row <= 31; ++row) {
    for (int column = 0; column <= 31; ++column) {
      const std::size_t at = Patch::at(column, row);
      patch.x[at] = 1.3F * (static_cast<float>(column) + random(at, 1)) - 3.0F;
      patch.y[at] = 1.2F * (static_cast<float>(row) + random(at, 2)) - 3.0F;
      patch.inverse_depth[at] = random(at, 3);
      patch.nearness[at] = 1.0F;
    }
  }
  Fragments many(40, 36), single(40, 36);
  const auto vertex = [&](int column, int row) {
    const std::size_t at = Patch::at(column, row);
    return Vertex{patch.x[at], patch.y[at], patch.inverse_depth[at], static_cast<float>(4 + column),
                  static_cast<float>(8 + row)};
  };
  for (int row = 0; row < 31; ++row) {
    EXPECT_EQ(draw_cells(patch, row, 0x7FFFFFFF, many), 0U);
    for (int column = 0; column < 31; ++column) {
      draw_quad(vertex(column, row), vertex(column + 1, row), vertex(column, row + 1),
                vertex(column + 1, row + 1), single);
    }
  }
  int drawn = 0;
  for (int y = 0; y < 36; ++y) {
    for (int x = 0; x < 40; ++x) {
      ASSERT_EQ(many.drawn(x, y), single.drawn(x, y)) << x << ", " << y;
      if (!many.drawn(x, y)) continue;
      ++drawn;
      ASSERT_EQ(many(x, y).inverse_depth, single(x, y).inverse_depth);
      ASSERT_NEAR(many(x, y).u, single(x, y).u, 1e-3F);
      ASSERT_NEAR(many(x, y).v, single(x, y).v, 1e-3F);
    }
  }
  EXPECT_GT(drawn, 1000);
}

TEST(SpeedPaths, OnlyBlocksOnOnePlaneAreFlat) {
  const auto display = square_display(200);
  const Frame frame = draw(textured_plane(glm::normalize(DVec3{0.5, 0.2, 1.0}), -1.0, 2.0),
                           grid_with_margin(display, 20), {});
  Frame dented = frame;
  dented.inverse_depth(45, 50) += 0.01F;
  const RelativeView relative = relative_view({}, kMoved, WarpOptions::Method::Mesh);
  Patch patch;
  const auto flat = [&](const Frame& of, float tolerance) {
    const SourceView view = of.view();
    MeshProjector(view, relative, display).load(32, 32, 31, 31, patch);
    return is_flat(patch, {0, 0, 31, 31}, tolerance);
  };
  EXPECT_TRUE(flat(frame, 1e-5F));
  EXPECT_FALSE(flat(dented, 1e-5F));
  EXPECT_TRUE(flat(dented, 0.02F));
  EXPECT_FALSE(flat(frame, -1.0F));
}

}  // namespace
}  // namespace macula::reprojection
