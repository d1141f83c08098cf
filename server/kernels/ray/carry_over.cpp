#include "server/kernels/ray/carry_over.h"

#include <algorithm>
#include <chrono>

#include "shared/units/time.h"

namespace macula::kernels::ray {

CarryOver::CarryOver(const MergeJob& merge, const Reprojector* moved,
                     const Plane<float>& depths_then, Cache& now, ViewBuffers& out,
                     SupportLuminance& luminance)
    : merge_(merge),
      moved_(moved),
      depths_then_(depths_then),
      now_(now),
      out_(out),
      luminance_(luminance) {}

/// Samples join a row once the depths of the next one are known, which may belong to another task.
CarryOver::Brought CarryOver::rows(int first, int last) const {
  Window window;
  Brought brought;
  for (int y = std::max(first - 1, 0); y <= std::min(last, now_.color.height() - 1); ++y) {
    find(y, window);
    if (y >= first && y < last) show(y, window.row);
    std::swap(window.depths[y % 3], window.row.inverse_depth);
    if (y > first) join(y - 1, window, brought);
  }
  if (last == now_.color.height()) join(last - 1, window, brought);
  return brought;
}

void CarryOver::find(int y, Window& window) const {
  if (moved_ != nullptr) {
    moved_->find(y, window.row);
  } else {
    const std::span<const float> row = depths_then_.row(y);
    window.row.inverse_depth.assign(row.begin(), row.end());
  }
}

void CarryOver::show(int y, const Reprojector::Row& row) const {
  if (moved_ != nullptr) {
    moved_->write(row);
  } else {
    std::ranges::copy(row.inverse_depth, now_.inverse_depth.row(y).begin());
  }
  show_row(now_, y, out_);
  if (merge_.support.y.chosen[y] != 0) note_luminance(y, row.inverse_depth);
}

void CarryOver::note_luminance(int y, std::span<const float> depths) const {
  const std::vector<int>& cells = merge_.support.x.cells;
  const int row = merge_.support.y.sample(y);
  const image::Tone& tone = merge_.view.tone;
  for (int i = 0; i < merge_.support.x.count(); ++i) {
    const int x = cells[i];
    const bool known = depths[x] >= 0.0F;
    const Rgb& fresh = merge_.fresh.radiance(merge_.fresh.at(x, y));
    luminance_.remembered(i, row) = known ? display_luminance(tone, out_.radiance(x, y)) : -1.0F;
    luminance_.fresh(i, row) = known ? display_luminance(tone, fresh) : 0.0F;
  }
}

void CarryOver::join(int y, Window& window, Brought& brought) const {
  const auto begin = std::chrono::steady_clock::now();
  const int last = now_.color.height() - 1;
  const auto depths = [&](int j) { return window.depths[std::clamp(j, 0, last) % 3].data(); };
  list_cells(y, window.depths[y % 3], window, brought);
  update_row(merge_, y, window.chosen,
             {depths(y - 1), depths(y), depths(y + 1), now_.color.width()}, now_, out_.radiance);
  for (const int x : window.chosen) finish_cell(merge_, x, y, now_, out_.depth_m);
  brought.joining_ms += units::to_ms(std::chrono::steady_clock::now() - begin);
}

/// The chosen without a branch: which cells are is chance.
void CarryOver::list_cells(int y, std::span<const float> depths, Window& window,
                           Brought& brought) const {
  const std::span<const Reason> reasons = merge_.mask.reasons().row(y);
  window.chosen.resize(reasons.size() + 1);
  std::size_t chosen = 0;
  for (std::size_t x = 0; x < reasons.size(); ++x) {
    window.chosen[chosen] = static_cast<int>(x);
    chosen += reasons[x] != Reason::None ? 1 : 0;
    if (depths[x] < 0.0F && reasons[x] == Reason::None)
      brought.forgotten.push_back({static_cast<int>(x), y});
  }
  window.chosen.resize(chosen);
}

}  // namespace macula::kernels::ray
