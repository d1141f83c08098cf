#include "tests/bench/reprojection_grids.h"

#include <algorithm>

namespace macula::bench {

SourcePicture without_guard(const SourcePicture& picture, const foveation::Display& display) {
  const DVec2 low = display.fov.tangent_min(), high = display.fov.tangent_max();
  const auto range = [](const std::vector<float>& edges, double from, double to) {
    const double slack = 0.25 * (edges[1] - edges[0]);
    const auto first = std::lower_bound(edges.begin(), edges.end(), from - slack);
    const auto last = std::upper_bound(edges.begin(), edges.end(), to + slack);
    return std::pair{static_cast<int>(first - edges.begin()),
                     static_cast<int>(last - edges.begin()) - 1};
  };
  const auto [left, right] = range(picture.grid.x_edges, low.x, high.x);
  const auto [top, bottom] = range(picture.grid.y_edges, low.y, high.y);
  SourcePicture cut{
      picture.stage_from_view,
      {{picture.grid.x_edges.begin() + left, picture.grid.x_edges.begin() + right + 1},
       {picture.grid.y_edges.begin() + top, picture.grid.y_edges.begin() + bottom + 1}},
      {right - left, bottom - top},
      {right - left, bottom - top}};
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      cut.color(x - left, y - top) = picture.color(x, y);
      cut.inverse_depth_per_m(x - left, y - top) = picture.inverse_depth_per_m(x, y);
    }
  }
  return cut;
}

PixelGrid shifted(PixelGrid grid) {
  for (std::vector<float>* edges : {&grid.x_edges, &grid.y_edges}) {
    const float half = 0.5F * ((*edges)[1] - (*edges)[0]);
    for (float& edge : *edges) edge += half;
  }
  return grid;
}

PixelGrid foveal_grid(const foveation::Display& display, double scale, Degrees guard,
                      const foveation::RateModel& model) {
  return foveation::make_foveal_grid(display, {}, model,
                                     {.fovea_oversampling = scale, .guard_band = guard});
}

PixelGrid three_times_finer(const PixelGrid& grid) {
  const auto split = [](const std::vector<float>& edges) {
    std::vector<float> finer{edges.front()};
    for (std::size_t i = 1; i < edges.size(); ++i) {
      const float step = (edges[i] - edges[i - 1]) / 3.0F;
      finer.insert(finer.end(), {edges[i - 1] + step, edges[i - 1] + 2.0F * step, edges[i]});
    }
    return finer;
  };
  return {split(grid.x_edges), split(grid.y_edges)};
}

}  // namespace macula::bench
