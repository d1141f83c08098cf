#include "server/session/view_builder.h"

#include <gtest/gtest.h>

#include "tests/server/session/session_fixtures.h"

namespace macula::session {
namespace {

class ViewBuilderTest : public testing::Test {
 protected:
  ViewBuilderTest() {
    setup_.eyes.assign(2, {math::symmetric_fov(Degrees{90.0}, 1.0), 256, 256});
    view_.eyes[0].head_from_eye.position = {-0.032, 0.0, 0.0};
    view_.eyes[1].head_from_eye.position = {0.032, 0.0, 0.0};
    for (net::EyeState& eye : view_.eyes) eye.fov = setup_.eyes[0].fov;
    policy_.guard_band = Degrees{0.0};
  }
  PreparedViews prepare(double scale = 1.0) {
    auto prepared = prepare_views(view_, setup_, policy_, scale, filters_);
    EXPECT_TRUE(prepared) << prepared.error().message();
    return std::move(*prepared);
  }

  net::ViewState view_ = test::view(1);
  ClientSetup setup_ = test::setup();
  ViewPolicy policy_;
  GazeFilters filters_;
};

// The stage stands at x = 10 and is turned by 90 degrees about +Y, which takes +X to -Z: an eye 32
// mm to the right of the head ends at z = -0.032 of it.
TEST_F(ViewBuilderTest, EyesStandWhereStageHeadAndEyePosesPutThem) {
  policy_.scene_from_stage.position = {10.0, 0.0, 0.0};
  policy_.scene_from_stage.rotation =
      glm::angleAxis(Radians{Degrees{90.0}}.value(), DVec3{0, 1, 0});
  view_.stage_from_head.position = {0.0, 1.6, 0.0};
  const PreparedViews prepared = prepare();
  const DVec3 right = prepared.views[1].world_from_view.position;
  EXPECT_NEAR(right.x, 10.0, 1e-12);
  EXPECT_NEAR(right.y, 1.6, 1e-12);
  EXPECT_NEAR(right.z, -0.032, 1e-12);
}

TEST_F(ViewBuilderTest, EachEyesGridFollowsItsOwnGaze) {
  view_.eyes[0].gaze.direction = glm::normalize(Vec3{-0.5F, 0.0F, -1.0F});
  view_.eyes[1].gaze.direction = glm::normalize(Vec3{0.5F, 0.0F, -1.0F});
  const PreparedViews prepared = prepare();
  const auto cell_width_at = [&](int eye, float tangent) {
    const PixelGrid& grid = prepared.views[eye].grid;
    const auto at = grid.locate({tangent, 0.0F});
    return grid.footprint(static_cast<int>(at->x), 0).x;
  };
  EXPECT_LT(cell_width_at(0, -0.5F), cell_width_at(0, 0.9F));
  EXPECT_LT(cell_width_at(1, 0.5F), cell_width_at(1, -0.9F));
}

TEST_F(ViewBuilderTest, AGazeThatGetsLostStaysWhereItWas) {
  view_.eyes[0].gaze.direction = glm::normalize(Vec3{0.3F, 0.1F, -1.0F});
  const Vec3 seen = prepare().views[0].gaze.direction;
  view_.eyes[0].gaze.direction = Vec3{0.0F};
  const Gaze held = prepare().views[0].gaze;
  EXPECT_EQ(held.direction, seen);
  EXPECT_FALSE(held.valid);
}

TEST_F(ViewBuilderTest, AUniformModelGivesTheDisplaysOwnPixels) {
  setup_.settings.rate_model = "uniform";
  const PreparedViews prepared = prepare();
  EXPECT_EQ(prepared.cells, 2U * 256U * 256U);
}

// Without a disc of full rate, only the cell at the gaze itself keeps its size: two columns and two
// rows for one, and one cell more where the other cells no longer fill the view evenly.
TEST_F(ViewBuilderTest, HalfTheScaleIsAQuarterOfTheCells) {
  setup_.settings.rate_model = "uniform";
  policy_.full_rate_radius = Degrees{0.0};
  const double ratio =
      static_cast<double>(prepare(1.0).cells) / static_cast<double>(prepare(0.5).cells);
  EXPECT_NEAR(ratio, 4.0, 0.15);
}

TEST_F(ViewBuilderTest, TheGazeKeepsTheDisplaysResolutionWhateverTheScale) {
  const auto pixel_at_gaze = [](const PreparedViews& prepared) {
    const kernels::View& view = prepared.views[0];
    const Vec2 at = view.grid.project(view.gaze.direction).value();
    return view.grid.footprint(static_cast<int>(at.x), static_cast<int>(at.y)).x;
  };
  const PreparedViews full = prepare(1.0), cheap = prepare(0.4);
  EXPECT_NEAR(pixel_at_gaze(cheap) / pixel_at_gaze(full), 1.0, 0.01);
  EXPECT_LT(cheap.cells, full.cells / 4);
}

TEST_F(ViewBuilderTest, AGuardBandWidensTheGridBeyondTheField) {
  policy_.guard_band = Degrees{5.0};
  const PixelGrid grid = prepare().views[0].grid;
  EXPECT_NEAR(grid.x_edges.back(), std::tan(Radians{Degrees{50.0}}.value()), 1e-5);
}

TEST_F(ViewBuilderTest, RefusesMoreCellsThanThePolicyAllows) {
  setup_.settings.rate_model = "uniform";
  policy_.most_cells = 1000;
  const auto prepared = prepare_views(view_, setup_, policy_, 1.0, filters_);
  ASSERT_FALSE(prepared);
  EXPECT_NE(prepared.error().message().find("at most 1000"), std::string::npos);
}

}  // namespace
}  // namespace macula::session
