#include "client/display/window/dashboard.h"

#include <gtest/gtest.h>
#include <algorithm>

namespace macula::display {
namespace {

Dashboard with_columns(std::initializer_list<StageColumn> columns) {
  Dashboard dashboard;
  dashboard.columns = columns;
  return dashboard;
}

int count(const image::Plane<Rgb8>& picture, frames::Stage stage) {
  return static_cast<int>(std::ranges::count(picture.pixels(), stage_color(stage)));
}

TEST(Dashboard, TheGraphIsAsHighAsTheNextRoundFigure) {
  EXPECT_EQ(graph_height_ms({}), 20.0F);
  EXPECT_EQ(graph_height_ms(with_columns({{10.0F, 9.0F}})), 20.0F);
  EXPECT_EQ(graph_height_ms(with_columns({{10.0F, 11.0F}})), 50.0F);
  EXPECT_EQ(graph_height_ms(with_columns({{0.0F, 51.0F}, {1.0F}})), 100.0F);
  EXPECT_EQ(graph_height_ms(with_columns({{1500.0F}})), 2000.0F);
}

TEST(Dashboard, OnlyWhatIsDrawnSetsTheScale) {
  Dashboard dashboard = with_columns({{900.0F}});
  for (std::size_t i = 0; i < Dashboard::kColumns; ++i) dashboard.columns.push_back({1.0F});
  EXPECT_EQ(graph_height_ms(dashboard), 20.0F);
}

TEST(Dashboard, AColumnsAreasAreItsStages) {
  const auto empty = draw_dashboard({}, 1);  // the legend's patches
  // 10 ms of rendering and 5 of decoding under 20 ms of 60 dots, two dots wide.
  StageColumn column{};
  column[static_cast<std::size_t>(frames::Stage::Render)] = 10.0F;
  column[static_cast<std::size_t>(frames::Stage::Decode)] = 5.0F;
  const auto drawn = draw_dashboard(with_columns({column}), 1);
  EXPECT_EQ(count(drawn, frames::Stage::Render) - count(empty, frames::Stage::Render), 2 * 30);
  EXPECT_EQ(count(drawn, frames::Stage::Decode) - count(empty, frames::Stage::Decode), 2 * 15);
}

TEST(Dashboard, AStageThatSeemsNegativeTakesNothing) {
  EXPECT_EQ(graph_height_ms(with_columns({{-30.0F, 19.0F}})), 20.0F);
}

TEST(Dashboard, LongLinesWidenIt) {
  Dashboard dashboard;
  dashboard.lines = {std::string(200, 'w')};
  EXPECT_GT(draw_dashboard(dashboard, 1).width(), draw_dashboard({}, 1).width());
  EXPECT_EQ(draw_dashboard(dashboard, 2).width(), 2 * draw_dashboard(dashboard, 1).width());
}

}  // namespace
}  // namespace macula::display
