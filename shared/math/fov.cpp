#include "shared/math/fov.h"

#include <cmath>
#include <numbers>

namespace macula::math {

Fov symmetric_fov(Radians vertical, double width_over_height) {
  const double half = 0.5 * vertical.value();
  const double half_width = std::atan(std::tan(half) * width_over_height);
  return {Radians{-half_width}, Radians{half_width}, Radians{half}, Radians{-half}};
}

bool is_valid(const Fov& fov) {
  const auto inside = [](Radians angle) {
    return std::isfinite(angle.value()) && std::abs(angle.value()) < 0.5 * std::numbers::pi;
  };
  return inside(fov.left) && inside(fov.right) && inside(fov.up) && inside(fov.down) &&
         fov.left < fov.right && fov.down < fov.up;
}

}  // namespace macula::math
