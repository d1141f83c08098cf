// Reading a picture between the middles of its cells. Pure.
#pragma once

#include <algorithm>
#include <cmath>

#include "shared/image/plane.h"
#include "shared/math/vec.h"

namespace macula::image {

/// Bilinear between the four nearest cells at `place` in continuous cells (cell i's middle is
/// i + 0.5); beyond the outermost middles the outermost cells go on.
template <class T>
T bilinear(const Plane<T>& cells, const Vec2& place) {
  const auto at = [&](int x, int y) {
    return cells(std::clamp(x, 0, cells.width() - 1), std::clamp(y, 0, cells.height() - 1));
  };
  const float left = std::floor(place.x - 0.5F), top = std::floor(place.y - 0.5F);
  const float tx = place.x - 0.5F - left, ty = place.y - 0.5F - top;
  const int i = static_cast<int>(left), j = static_cast<int>(top);
  return (1.0F - ty) * ((1.0F - tx) * at(i, j) + tx * at(i + 1, j)) +
         ty * ((1.0F - tx) * at(i, j + 1) + tx * at(i + 1, j + 1));
}

}  // namespace macula::image
