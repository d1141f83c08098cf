#include "client/display/window/comparison.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "shared/base/check.h"

namespace macula::display {
namespace {

std::uint8_t magnified(std::uint8_t a, std::uint8_t b) {
  constexpr int kTimes = 4;
  return static_cast<std::uint8_t>(std::min(kTimes * std::abs(a - b), 255));
}

}  // namespace

ComparisonView next(ComparisonView view) {
  switch (view) {
    case ComparisonView::Off:
      return ComparisonView::Wipe;
    case ComparisonView::Wipe:
      return ComparisonView::Flip;
    case ComparisonView::Flip:
      return ComparisonView::Difference;
    case ComparisonView::Difference:
      break;
  }
  return ComparisonView::Off;
}

image::Plane<Rgb8> wiped(const image::Plane<Rgb8>& first, const image::Plane<Rgb8>& second,
                         float share) {
  MACULA_CHECK(first.rect() == second.rect(), "both pictures have one size");
  constexpr Rgb8 kLine{255, 255, 255};
  image::Plane<Rgb8> picture = first;
  const int width = first.width();
  const int from =
      std::clamp(static_cast<int>(std::lround(share * static_cast<float>(width))), 0, width);
  for (int y = 0; y < first.height(); ++y) {
    const auto to = picture.row(y);
    const auto behind = second.row(y);
    std::copy(behind.begin() + from, behind.end(), to.begin() + from);
    for (int x = std::max(from - 1, 0); x < std::min(from + 1, width); ++x) to[x] = kLine;
  }
  return picture;
}

image::Plane<Rgb8> difference_map(const image::Plane<Rgb8>& first,
                                  const image::Plane<Rgb8>& second) {
  MACULA_CHECK(first.rect() == second.rect(), "both pictures have one size");
  image::Plane<Rgb8> map(first.width(), first.height());
  const auto a = first.pixels(), b = second.pixels();
  std::transform(a.begin(), a.end(), b.begin(), map.data(), [](Rgb8 p, Rgb8 q) {
    return Rgb8{magnified(p.r, q.r), magnified(p.g, q.g), magnified(p.b, q.b)};
  });
  return map;
}

}  // namespace macula::display
