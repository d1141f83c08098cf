// Dashboard: what a watcher of the stream wants to see of it, as a small picture: figures in lines
// and the stage times of the newest frames as stacked columns, on one scale. Pure drawing; knows no
// window.
#pragma once

#include <array>
#include <deque>
#include <string>
#include <vector>

#include "client/frames/stages.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::display {

/// One shown server frame's time, in frames::Stage's order, ms; negative ones count as 0.
using StageColumn = std::array<float, frames::kStageCount>;

struct Dashboard {
  static constexpr std::size_t kColumns = 90;  ///< drawn: the newest

  std::vector<std::string> lines;
  std::deque<StageColumn> columns;  ///< newest last
};

/// What a column as high as the graph stands for: the least of 20, 50, 100, 200, 500, ... ms that
/// holds every column drawn.
float graph_height_ms(const Dashboard& dashboard);
Rgb8 stage_color(frames::Stage stage);
/// Lines of text, then the graph with its legend. `dot_px`: the size of a letter's dots.
image::Plane<Rgb8> draw_dashboard(const Dashboard& dashboard, int dot_px);
/// Lines of text on the same ground.
image::Plane<Rgb8> draw_lines(const std::vector<std::string>& lines, int dot_px);

}  // namespace macula::display
