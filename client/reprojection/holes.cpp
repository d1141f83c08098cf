#include "client/reprojection/holes.h"

#include <cmath>
#include <utility>
#include <vector>

namespace macula::reprojection {
namespace {

constexpr int kNone = -1;

/// An undrawn pixel and the nearest drawn ones in its row and column (their column or row, or
/// kNone).
struct Gap {
  int x, y;
  int left, right = kNone, upper, lower = kNone;

  bool enclosed() const {
    return (left != kNone && right != kNone) || (upper != kNone && lower != kNone);
  }
};

/// Top-down: left, right and upper neighbours.
std::vector<Gap> find_gaps(const Fragments& fragments) {
  std::vector<Gap> gaps;
  std::vector<int> upper(static_cast<std::size_t>(fragments.width()), kNone);
  for (int y = 0; y < fragments.height(); ++y) {
    const auto row = fragments.row(y);
    const std::size_t first_of_row = gaps.size();
    int left = kNone;
    for (int x = 0; x < fragments.width(); ++x) {
      if (row[x].drawn()) {
        left = x;
        upper[x] = y;
      } else {
        gaps.push_back({.x = x, .y = y, .left = left, .upper = upper[x]});
      }
    }
    int right = kNone, x = fragments.width() - 1;
    for (std::size_t i = gaps.size(); i-- > first_of_row;) {
      for (; x > gaps[i].x; --x) {
        if (row[x].drawn()) right = x;
      }
      gaps[i].right = right;
    }
  }
  return gaps;
}

/// Bottom-up: lower neighbours.
void find_lower(const Fragments& fragments, std::vector<Gap>& gaps) {
  std::vector<int> lower(static_cast<std::size_t>(fragments.width()), kNone);
  std::size_t next = gaps.size();
  for (int y = fragments.height(); y-- > 0 && next > 0;) {
    if (gaps[next - 1].y == y) {
      for (; next > 0 && gaps[next - 1].y == y; --next) {
        gaps[next - 1].lower = lower[gaps[next - 1].x];
      }
    }
    const auto row = fragments.row(y);
    for (int x = 0; x < fragments.width(); ++x) {
      if (row[x].drawn()) lower[x] = y;
    }
  }
}

/// A drawn pixel beside a gap, and the way that leads on from it, away from the gap.
struct Side {
  int x, y, step_x, step_y;
};

/// The fragment a side offers: the one behind the border pixel, where that is the same surface. The
/// border's own colour is a mixture with what stood before it: its cell was cut by the silhouette.
Fragment offered_by(const Fragments& fragments, const Side& side) {
  constexpr float kSameSurface = 0.05F;  // relative step of inverse depth within one surface
  const Fragment border = fragments(side.x, side.y);
  const int x = side.x + side.step_x, y = side.y + side.step_y;
  if (!fragments.contains(x, y) || !fragments(x, y).drawn()) return border;
  const Fragment behind = fragments(x, y);
  const float step = std::abs(behind.inverse_depth - border.inverse_depth);
  return step <= kSameSurface * border.inverse_depth ? behind : border;
}

Fragment farther_of(const Fragments& fragments, const Side& one, const Side& other) {
  const Fragment a = offered_by(fragments, one), b = offered_by(fragments, other);
  return a.inverse_depth <= b.inverse_depth ? a : b;
}

/// The farther end of the shorter way across the hole: an uncovered strip is filled across its
/// width, not along its length, where a third surface may begin.
Fragment farther_neighbour(const Fragments& fragments, const Gap& gap) {
  const bool sideways = gap.left != kNone && gap.right != kNone;
  const bool upright = gap.upper != kNone && gap.lower != kNone;
  if (sideways && (!upright || gap.right - gap.left <= gap.lower - gap.upper)) {
    return farther_of(fragments, {gap.left, gap.y, -1, 0}, {gap.right, gap.y, 1, 0});
  }
  return farther_of(fragments, {gap.x, gap.upper, 0, -1}, {gap.x, gap.lower, 0, 1});
}

}  // namespace

void classify_and_fill(Fragments& fragments, WarpOptions::Holes holes,
                       image::Plane<Coverage>& coverage) {
  coverage.resize(fragments.width(), fragments.height(), Coverage::Covered);
  std::vector<Gap> gaps = find_gaps(fragments);
  find_lower(fragments, gaps);
  std::vector<std::pair<Gap, Fragment>> fills;  // written last: fills must not feed on fills
  for (const Gap& gap : gaps) {
    coverage(gap.x, gap.y) = gap.enclosed() ? Coverage::Filled : Coverage::Outside;
    if (gap.enclosed() && holes == WarpOptions::Holes::FillFartherSide) {
      fills.emplace_back(gap, farther_neighbour(fragments, gap));
    }
  }
  for (const auto& [gap, fragment] : fills) fragments(gap.x, gap.y) = fragment;
}

}  // namespace macula::reprojection
