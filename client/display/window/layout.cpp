#include "client/display/window/layout.h"

#include <algorithm>
#include <cmath>

namespace macula::display {
namespace {

/// Whole pixels before what is centred; rounding may make it a hair larger than the room.
double border(int room_px, double shown_px) {
  return std::max(0.0, std::floor((room_px - shown_px) / 2.0));
}

}  // namespace

std::vector<image::Rect> place_side_by_side(std::span<const PictureSize> pictures,
                                            PictureSize framebuffer) {
  double width = 0.0, height = 0.0;
  for (const auto& picture : pictures) {
    width += picture.width_px;
    height = std::max<double>(height, picture.height_px);
  }
  std::vector<image::Rect> places(pictures.size());
  if (width <= 0.0 || height <= 0.0) return places;
  const double scale = std::min(framebuffer.width_px / width, framebuffer.height_px / height);
  double left = border(framebuffer.width_px, scale * width);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const double right = left + scale * pictures[i].width_px;
    const double shown_height = scale * pictures[i].height_px;
    const double top = border(framebuffer.height_px, shown_height);
    // Neighbours share their rounded edge: no gap, no overlap.
    const int x = static_cast<int>(std::lround(left)), x_end = static_cast<int>(std::lround(right));
    places[i] = {x, static_cast<int>(top), x_end - x, static_cast<int>(std::lround(shown_height))};
    left = right;
  }
  return places;
}

std::optional<PictureTarget> picture_at(std::span<const image::Rect> places, float x_px,
                                        float y_px) {
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto& place = places[i];
    if (place.width <= 0 || place.height <= 0) continue;
    const float u = (x_px - static_cast<float>(place.x)) / static_cast<float>(place.width);
    const float v = (y_px - static_cast<float>(place.y)) / static_cast<float>(place.height);
    if (u >= 0.0F && u < 1.0F && v >= 0.0F && v < 1.0F)
      return PictureTarget{static_cast<int>(i), {u, v}};
  }
  return std::nullopt;
}

}  // namespace macula::display
