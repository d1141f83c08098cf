#include "client/reprojection/holes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <utility>

namespace macula::reprojection {
namespace {

using Gap = Holes::Gap;

constexpr int kRun = 16;  ///< pixels looked at together: rows are nearly always drawn

/// Whether no depth has a sign: what is undrawn is negative.
bool run_is_drawn(const float* depths) {
  std::uint32_t any = 0;
  for (int i = 0; i < kRun; ++i) any |= std::bit_cast<std::uint32_t>(depths[i]);
  return (any >> 31) == 0;
}

/// The undrawn pixels of a row, left to right, with their left neighbours.
void find_row_gaps(const Fragments& fragments, int y, std::vector<Gap>& gaps) {
  const float* const depths = fragments.inverse_depths(y);
  int left = Gap::kNone;
  for (int begin = 0; begin < fragments.width(); begin += kRun) {
    const int end = std::min(begin + kRun, fragments.width());
    if (end - begin == kRun && run_is_drawn(depths + begin)) {
      left = end - 1;
      continue;
    }
    for (int x = begin; x < end; ++x) {
      if (depths[x] >= 0.0F) {
        left = x;
      } else {
        gaps.push_back({.x = x, .y = y, .left = left});
      }
    }
  }
}

/// Gaps of one row, from its end: the right neighbours.
void find_right(int width, std::span<Gap> row) {
  for (std::size_t i = row.size(); i-- > 0;) {
    const int next = row[i].x + 1;
    if (next == width) continue;
    row[i].right = i + 1 < row.size() && row[i + 1].x == next ? row[i + 1].right : next;
  }
}

/// Top-down and bottom-up; a gap beside a gap continues it, any other begins beside a drawn pixel.
void find_upper_and_lower(const Fragments& fragments, std::vector<Gap>& gaps) {
  std::vector<int> last(static_cast<std::size_t>(fragments.width()), Gap::kNone);
  for (Gap& gap : gaps) {
    if (gap.y > 0 && fragments.drawn(gap.x, gap.y - 1)) last[gap.x] = gap.y - 1;
    gap.upper = last[gap.x];
  }
  std::fill(last.begin(), last.end(), Gap::kNone);
  for (std::size_t i = gaps.size(); i-- > 0;) {
    Gap& gap = gaps[i];
    const bool ends = gap.y + 1 < fragments.height() && fragments.drawn(gap.x, gap.y + 1);
    if (ends) last[gap.x] = gap.y + 1;
    gap.lower = last[gap.x];
  }
}

/// A drawn pixel beside a gap, and the way that leads on from it, away from the gap.
struct Side {
  int x, y, step_x, step_y;
};

/// The pixel a side offers: the one behind the border pixel, where that is the same surface. The
/// border's own colour is a mixture with what stood before it: its cell was cut by the silhouette.
image::Pixel offered_by(const Fragments& fragments, const Side& side) {
  constexpr float kSameSurface = 0.05F;  // relative step of inverse depth within one surface
  const int x = side.x + side.step_x, y = side.y + side.step_y;
  if (!fragments.contains(x, y) || !fragments.drawn(x, y)) return {side.x, side.y};
  const float border = fragments.inverse_depth(side.x, side.y);
  const float step = std::abs(fragments.inverse_depth(x, y) - border);
  return step <= kSameSurface * border ? image::Pixel{x, y} : image::Pixel{side.x, side.y};
}

image::Pixel farther_of(const Fragments& fragments, const Side& one, const Side& other) {
  const image::Pixel a = offered_by(fragments, one), b = offered_by(fragments, other);
  return fragments.inverse_depth(a.x, a.y) <= fragments.inverse_depth(b.x, b.y) ? a : b;
}

/// The farther end of the shorter way across the hole: an uncovered strip is filled across its
/// width, not along its length, where a third surface may begin.
image::Pixel farther_neighbour(const Fragments& fragments, const Gap& gap) {
  const bool sideways = gap.left != Gap::kNone && gap.right != Gap::kNone;
  const bool upright = gap.upper != Gap::kNone && gap.lower != Gap::kNone;
  if (sideways && (!upright || gap.right - gap.left <= gap.lower - gap.upper)) {
    return farther_of(fragments, {gap.left, gap.y, -1, 0}, {gap.right, gap.y, 1, 0});
  }
  return farther_of(fragments, {gap.x, gap.upper, 0, -1}, {gap.x, gap.lower, 0, 1});
}

}  // namespace

void Holes::note_row(const Fragments& fragments, int y) {
  const std::size_t first = gaps_.size();
  find_row_gaps(fragments, y, gaps_);
  find_right(fragments.width(), std::span(gaps_).subspan(first));
}

Holes::Counts Holes::classify_and_fill(const Fragments& fragments, WarpOptions::Holes holes,
                                       int side_px, image::Plane<Rgb8>& colors,
                                       image::Plane<Coverage>* coverage) {
  if (coverage != nullptr) {
    coverage->resize(side_px * fragments.width(), side_px * fragments.height(), Coverage::Covered);
  }
  find_upper_and_lower(fragments, gaps_);
  const int pixels = side_px * side_px;
  Counts counts;
  for (const Gap& gap : gaps_) {
    const bool hole = gap.enclosed();
    (hole ? counts.filled_px : counts.outside_px) += static_cast<std::uint64_t>(pixels);
    const bool filled = hole && holes == WarpOptions::Holes::FillFartherSide;
    // Drawn: never itself a fill.
    const image::Pixel from = filled ? farther_neighbour(fragments, gap) : image::Pixel{};
    for (int i = 0; i < pixels; ++i) {
      const int column = i % side_px, row = i / side_px;
      const int x = side_px * gap.x + column, y = side_px * gap.y + row;
      if (coverage != nullptr) (*coverage)(x, y) = hole ? Coverage::Filled : Coverage::Outside;
      if (filled) colors(x, y) = colors(side_px * from.x + column, side_px * from.y + row);
    }
  }
  return counts;
}

}  // namespace macula::reprojection
