#include "server/kernels/ray/cell_pattern.h"

#include <cmath>

#include "server/sampling/sobol.h"

namespace macula::kernels::ray {
namespace {

constexpr std::uint32_t kPositionDimension =
    0;  // and the 2 x samples that follow: kLast in lighting

int side_of_square(int count) {
  const int side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(count))));
  return side * side == count ? side : 0;
}

}  // namespace

CellPattern::CellPattern(int samples, Placement placement)
    : samples_(samples),
      placement_(placement),
      side_(side_of_square(samples)),
      guide_(side_ > 0 ? (side_ / 2) * side_ + side_ / 2 : 0) {}

bool CellPattern::guide_is_central() const {
  return placement_ == Placement::Fixed && side_ % 2 == 1;
}

Vec2 CellPattern::position(sampling::SampleKey key, int s) const {
  const auto index = static_cast<std::uint32_t>(s);
  if (side_ == 0) {
    return sampling::sobol_owen_2d(index, placement_ == Placement::Jittered
                                              ? sampling::scramble_seed(key, kPositionDimension)
                                              : 0U);
  }
  const Vec2 corner{static_cast<float>(s % side_), static_cast<float>(s / side_)};
  const Vec2 offset = placement_ == Placement::Jittered
                          ? sampling::sample_2d(key, kPositionDimension + 2U * index)
                          : Vec2{0.5F};
  // Rounding may carry the last part's end to 1: still inside the closed cell.
  return (corner + offset) / static_cast<float>(side_);
}

}  // namespace macula::kernels::ray
