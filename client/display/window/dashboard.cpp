#include "client/display/window/dashboard.h"

#include <algorithm>

#include "shared/image/lettering.h"

namespace macula::display {
namespace {

constexpr Rgb8 kGround{18, 20, 24}, kText{226, 226, 220}, kGrid{70, 74, 80};
constexpr int kColumn_dots = 2, kGraph_dots = 60, kMargin_dots = 4, kLine_dots = 10;

void fill(image::Plane<Rgb8>& picture, const image::Rect& rect, Rgb8 color) {
  const int end = std::min(rect.x + rect.width, picture.width());
  for (int y = std::max(rect.y, 0); y < std::min(rect.y + rect.height, picture.height()); ++y)
    for (int x = std::max(rect.x, 0); x < end; ++x) picture(x, y) = color;
}

int widest_px(const std::vector<std::string>& lines, int dot_px) {
  int width = 0;
  for (const std::string& line : lines) width = std::max(width, image::text_width_px(line, dot_px));
  return width;
}

/// `top_px` is where the first line begins; returns where the next would.
int draw_text_lines(image::Plane<Rgb8>& picture, const std::vector<std::string>& lines, int top_px,
                    int dot_px) {
  for (const std::string& line : lines) {
    image::draw_text(picture, {kMargin_dots * dot_px, top_px}, line, dot_px, kText);
    top_px += kLine_dots * dot_px;
  }
  return top_px;
}

float total_ms(const StageColumn& column) {
  float sum = 0.0F;
  for (const float stage : column) sum += std::max(stage, 0.0F);
  return sum;
}

std::size_t first_drawn(const Dashboard& dashboard) {
  const std::size_t count = dashboard.columns.size();
  return count - std::min(count, Dashboard::kColumns);
}

/// One frame: its stages from the bottom up.
void draw_column(image::Plane<Rgb8>& picture, const StageColumn& column, int left_px, int bottom_px,
                 float px_per_ms, int dot_px) {
  float below_ms = 0.0F;
  for (std::size_t i = 0; i < column.size(); ++i) {
    const float above_ms = below_ms + std::max(column[i], 0.0F);
    const int lower = bottom_px - static_cast<int>(below_ms * px_per_ms);
    const int upper = bottom_px - static_cast<int>(above_ms * px_per_ms);
    fill(picture, {left_px, upper, kColumn_dots * dot_px, lower - upper},
         stage_color(static_cast<frames::Stage>(i)));
    below_ms = above_ms;
  }
}

void draw_legend(image::Plane<Rgb8>& picture, int left_px, int top_px, int dot_px) {
  // Top to bottom as the columns are.
  for (std::size_t i = frames::kStageCount; i-- > 0;) {
    const auto stage = static_cast<frames::Stage>(i);
    fill(picture, {left_px, top_px, 5 * dot_px, 5 * dot_px}, stage_color(stage));
    image::draw_text(picture, {left_px + 8 * dot_px, top_px}, frames::name(stage), dot_px, kText);
    top_px += kLine_dots * dot_px;
  }
}

void draw_graph(image::Plane<Rgb8>& picture, const Dashboard& dashboard, int top_px, int dot_px) {
  const int left = kMargin_dots * dot_px;
  const int width = static_cast<int>(Dashboard::kColumns) * kColumn_dots * dot_px;
  const int height = kGraph_dots * dot_px, bottom = top_px + height;
  const float whole_ms = graph_height_ms(dashboard);
  for (const int share : {0, 1, 2})
    fill(picture, {left, top_px + share * (height - 1) / 2, width, 1}, kGrid);
  const std::size_t first = first_drawn(dashboard);
  for (std::size_t i = first; i < dashboard.columns.size(); ++i)
    draw_column(picture, dashboard.columns[i],
                left + static_cast<int>(i - first) * kColumn_dots * dot_px, bottom,
                static_cast<float>(height) / whole_ms, dot_px);
  image::draw_text(picture, {left + dot_px, top_px + 2 * dot_px},
                   std::to_string(static_cast<int>(whole_ms)) + " ms", dot_px, kText);
  draw_legend(picture, left + width + kMargin_dots * dot_px, top_px, dot_px);
}

}  // namespace

float graph_height_ms(const Dashboard& dashboard) {
  float most = 0.0F;
  for (std::size_t i = first_drawn(dashboard); i < dashboard.columns.size(); ++i)
    most = std::max(most, total_ms(dashboard.columns[i]));
  float decade = 10.0F;
  while (true) {
    for (const float step : {2.0F, 5.0F, 10.0F})
      if (most <= step * decade) return step * decade;
    decade *= 10.0F;
  }
}

Rgb8 stage_color(frames::Stage stage) {
  // Waiting in greys, work and ways in colours.
  static constexpr std::array<Rgb8, frames::kStageCount> kColors{
      Rgb8{86, 180, 233}, Rgb8{110, 110, 110}, Rgb8{230, 159, 0},
      Rgb8{240, 228, 66}, Rgb8{150, 150, 150}, Rgb8{0, 114, 178},
      Rgb8{0, 158, 115},  Rgb8{204, 121, 167}, Rgb8{190, 190, 190}};
  return kColors[static_cast<std::size_t>(stage)];
}

image::Plane<Rgb8> draw_dashboard(const Dashboard& dashboard, int dot_px) {
  constexpr int kLegend_dots = 100;
  const int text_px = widest_px(dashboard.lines, dot_px);
  const int graph_px =
      (static_cast<int>(Dashboard::kColumns) * kColumn_dots + kLegend_dots) * dot_px;
  const int lines_px = static_cast<int>(dashboard.lines.size()) * kLine_dots * dot_px;
  const int legend_px = static_cast<int>(frames::kStageCount) * kLine_dots * dot_px;
  const int below_px = std::max(legend_px, kGraph_dots * dot_px);
  image::Plane<Rgb8> picture(std::max(text_px, graph_px) + 2 * kMargin_dots * dot_px,
                             lines_px + below_px + 3 * kMargin_dots * dot_px, kGround);
  const int top_px = draw_text_lines(picture, dashboard.lines, kMargin_dots * dot_px, dot_px);
  draw_graph(picture, dashboard, top_px + kMargin_dots * dot_px, dot_px);
  return picture;
}

image::Plane<Rgb8> draw_lines(const std::vector<std::string>& lines, int dot_px) {
  image::Plane<Rgb8> picture(
      widest_px(lines, dot_px) + 2 * kMargin_dots * dot_px,
      (static_cast<int>(lines.size()) * kLine_dots + 2 * kMargin_dots) * dot_px, kGround);
  draw_text_lines(picture, lines, kMargin_dots * dot_px, dot_px);
  return picture;
}

}  // namespace macula::display
