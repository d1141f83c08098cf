#include "client/app/age_badge.h"

#include <algorithm>
#include <cstdio>

#include "shared/image/lettering.h"

namespace macula::client_app {

std::string age_badge(Nanoseconds age) {
  if (age < kBadgeAfter) return {};
  char text[32];
  const double seconds = units::to_s(age);
  std::snprintf(text, sizeof text, seconds < 10.0 ? "%.1f s old" : "%.0f s old", seconds);
  return text;
}

void draw_age_badge(image::Plane<Rgb8>& picture, Nanoseconds age) {
  const std::string text = age_badge(age);
  if (text.empty() || picture.empty()) return;
  constexpr Rgb8 kDark{24, 16, 0}, kAmber{255, 176, 32};
  const int dot = std::max(1, picture.width() / 200), margin = 3 * dot;
  const int width = image::text_width_px(text, dot), height = image::text_height_px(dot);
  const int left = std::max(0, (picture.width() - width) / 2), top = picture.height() / 4;
  for (int y = std::max(0, top - margin); y < std::min(picture.height(), top + height + margin);
       ++y) {
    const auto row = picture.row(y);
    std::fill(row.begin() + std::max(0, left - margin),
              row.begin() + std::min(picture.width(), left + width + margin), kDark);
  }
  image::draw_text(picture, {left, top}, text, dot, kAmber);
}

}  // namespace macula::client_app
