#include "server/kernels/ray/carry_over.h"

#include <algorithm>
#include <chrono>

#include "server/kernels/ray/resampling.h"
#include "shared/units/time.h"

namespace macula::kernels::ray {

CarryOver::CarryOver(const MergeJob& merge, const Reprojector* moved,
                     const Plane<float>& depths_then, Cache& now, ViewBuffers& out,
                     Plane<float>& seen)
    : merge_(merge), moved_(moved), depths_then_(depths_then), now_(now), out_(out), seen_(seen) {}

/// Samples join a row once the depths of the next one are known, which may belong to another task.
double CarryOver::rows(int first, int last) const {
  Window window;
  double joining_ms = 0.0;
  for (int y = std::max(first - 1, 0); y <= std::min(last, now_.color.height() - 1); ++y) {
    find(y, window);
    if (y >= first && y < last) show(y, window);
    if (y > first) joining_ms += join(y - 1, window);
  }
  if (last == now_.color.height()) joining_ms += join(last - 1, window);
  return joining_ms;
}

void CarryOver::find(int y, Window& window) const {
  std::vector<float>& depths = window.depths[y % 3];
  if (moved_ == nullptr) {
    const std::span<const float> row = depths_then_.row(y);
    depths.assign(row.begin(), row.end());
    return;
  }
  moved_->find(y, window.row);
  depths = window.row.inverse_depth;
}

void CarryOver::show(int y, const Window& window) const {
  const std::vector<float>& depths = window.depths[y % 3];
  if (moved_ != nullptr) {
    moved_->write(window.row);
  } else {
    std::ranges::copy(depths, now_.inverse_depth.row(y).begin());
  }
  show_row(now_, y, out_);
  if (merge_.support.y.chosen[y] != 0) note_seen(y, depths);
}

void CarryOver::note_seen(int y, std::span<const float> remembered) const {
  const std::vector<int>& cells = merge_.support.x.cells;
  const std::span<const Rgb> radiance = out_.radiance.row(y);
  const std::span<float> seen = seen_.row(merge_.support.y.sample(y));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (remembered[cells[i]] < 0.0F) continue;
    seen[i] = display_luminance(merge_.view.tone, radiance[cells[i]]);
  }
}

double CarryOver::join(int y, Window& window) const {
  const auto begin = std::chrono::steady_clock::now();
  list_chosen(y, window.columns);
  const int last = now_.color.height() - 1;
  const auto depths = [&](int j) { return window.depths[std::clamp(j, 0, last) % 3].data(); };
  update_row(merge_, y, window.columns,
             {depths(y - 1), depths(y), depths(y + 1), now_.color.width()}, now_, out_.radiance);
  for (const int x : window.columns) finish_cell(merge_, x, y, now_, out_.depth_m);
  return units::to_ms(std::chrono::steady_clock::now() - begin);
}

/// Written without a branch: which cells are traced is chance.
void CarryOver::list_chosen(int y, std::vector<int>& columns) const {
  const std::span<const Reason> reasons = merge_.mask.reasons().row(y);
  columns.resize(reasons.size() + 1);
  std::size_t count = 0;
  for (std::size_t x = 0; x < reasons.size(); ++x) {
    columns[count] = static_cast<int>(x);
    count += reasons[x] != Reason::None ? 1 : 0;
  }
  columns.resize(count);
}

}  // namespace macula::kernels::ray
