#include "client/display/headless/rate_map.h"

#include <algorithm>
#include <cmath>

#include "shared/image/draw.h"
#include "shared/math/frames.h"

namespace macula::display {
namespace {

constexpr float kLowestLog2Density = -6.0F;
constexpr Rgb8 kOutside{0, 0, 0};
constexpr Rgb8 kCross{255, 40, 40};

void draw_gaze(const foveation::Display& display, const Gaze& gaze, image::Plane<Rgb8>& picture) {
  if (!(gaze.direction.z < 0.0F)) return;
  const DVec2 at =
      (DVec2(math::tangent_from_direction(gaze.direction)) - display.fov.tangent_min()) /
      display.pixel_tangent();
  const image::Pixel centre{static_cast<int>(std::clamp(at.x, -1e6, 1e6)),
                            static_cast<int>(std::clamp(at.y, -1e6, 1e6))};
  if (!picture.contains(centre.x, centre.y)) return;
  image::draw_cross(picture, centre, std::max(6, picture.width() / 40), kCross);
}

}  // namespace

float cell_density(const PixelGrid& grid, const foveation::Display& display, const Vec2& tangent) {
  const auto cell = grid.locate(tangent);
  if (!cell) return 0.0F;
  const int x = std::clamp(static_cast<int>(cell->x), 0, grid.width() - 1);
  const int y = std::clamp(static_cast<int>(cell->y), 0, grid.height() - 1);
  const Vec2 footprint = grid.footprint(x, y);
  const DVec2 nominal = display.pixel_tangent();
  return static_cast<float>(nominal.x * nominal.y /
                            (static_cast<double>(footprint.x) * footprint.y));
}

image::Plane<Rgb8> draw_rate_map(const PixelGrid& grid, const foveation::Display& display,
                                 const Gaze& gaze) {
  image::Plane<Rgb8> picture(display.width_px, display.height_px);
  const DVec2 corner = display.fov.tangent_min(), pixel = display.pixel_tangent();
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const Vec2 tangent(corner + pixel * DVec2(x + 0.5, y + 0.5));
      const float density = cell_density(grid, display, tangent);
      picture(x, y) = density > 0.0F
                          ? image::false_color(1.0F - std::log2(density) / kLowestLog2Density)
                          : kOutside;
    }
  }
  draw_gaze(display, gaze, picture);
  return picture;
}

}  // namespace macula::display
