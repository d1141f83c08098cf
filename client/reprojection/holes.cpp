#include "client/reprojection/holes.h"

#include <array>
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

/// The farthest of the four drawn neighbours; of equally far ones the nearest on the screen.
Fragment farthest_neighbour(const Fragments& fragments, const Gap& gap) {
  struct Candidate {
    int at, distance;
    bool sideways;
  };
  const std::array<Candidate, 4> candidates{{{gap.left, gap.x - gap.left, true},
                                             {gap.right, gap.right - gap.x, true},
                                             {gap.upper, gap.y - gap.upper, false},
                                             {gap.lower, gap.lower - gap.y, false}}};
  Fragment best;
  int best_distance = 0;
  for (const Candidate& candidate : candidates) {
    if (candidate.at == kNone) continue;
    const Fragment& there =
        candidate.sideways ? fragments(candidate.at, gap.y) : fragments(gap.x, candidate.at);
    const bool farther = there.inverse_depth < best.inverse_depth;
    const bool nearer_on_screen =
        there.inverse_depth == best.inverse_depth && candidate.distance < best_distance;
    if (best.drawn() && !farther && !nearer_on_screen) continue;
    best = there;
    best_distance = candidate.distance;
  }
  return best;
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
      fills.emplace_back(gap, farthest_neighbour(fragments, gap));
    }
  }
  for (const auto& [gap, fragment] : fills) fragments(gap.x, gap.y) = fragment;
}

}  // namespace macula::reprojection
