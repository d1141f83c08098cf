#include "tests/bench/figure_sheet.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "shared/image/draw.h"
#include "shared/image/lettering.h"

namespace macula::bench {
namespace {

constexpr Rgb8 kInk{235, 235, 235};
constexpr int kMarginPx = 5;

int line_px(int dot) {
  return image::text_height_px(dot) + kMarginPx;
}

Plane<Rgb8> lettered(int width_px, std::span<const std::string> lines, int dot) {
  const int count = static_cast<int>(lines.size());
  Plane<Rgb8> picture(width_px, count * line_px(dot) + kMarginPx);
  for (int k = 0; k < count; ++k) {
    image::draw_text(picture, {kMarginPx, kMarginPx + k * line_px(dot)},
                     lines[static_cast<std::size_t>(k)], dot, kInk);
  }
  return picture;
}

}  // namespace

int dot_px(int picture_width_px) {
  constexpr int kWidthOfADot = 240;
  return std::max(1, (picture_width_px + kWidthOfADot / 2) / kWidthOfADot);
}

Plane<Rgb8> stacked(const Plane<Rgb8>& above, const Plane<Rgb8>& below) {
  Plane<Rgb8> picture(above.width(), above.height() + below.height());
  for (int y = 0; y < picture.height(); ++y) {
    const auto row = y < above.height() ? above.row(y) : below.row(y - above.height());
    std::ranges::copy(row, picture.row(y).begin());
  }
  return picture;
}

Plane<Rgb8> captioned(const Plane<Rgb8>& picture, std::span<const std::string> lines) {
  return stacked(picture, lettered(picture.width(), lines, dot_px(picture.width())));
}

Plane<Rgb8> scale_bar(const ColorScale& scale, int width_px) {
  constexpr int kTicks = 5;
  const int dot = std::min(dot_px(width_px), 2), bar_px = 10 * dot;
  Plane<Rgb8> bar(width_px, bar_px + 2 * line_px(dot) + kMarginPx);
  for (int x = 0; x < width_px; ++x) {
    const Rgb8 color =
        image::false_color((static_cast<float>(x) + 0.5F) / static_cast<float>(width_px));
    for (int y = 0; y < bar_px; ++y) bar(x, y) = color;
  }
  for (int i = 0; i < kTicks; ++i) {
    const float t = static_cast<float>(i) / (kTicks - 1);
    const float value = std::lerp(scale.low, scale.high, t);
    char text[32];
    std::snprintf(
        text, sizeof text, "%.3g",
        scale.ticks == Ticks::Decades ? std::pow(10.0, value) : static_cast<double>(value));
    const int width = image::text_width_px(text, dot);
    const int x = static_cast<int>(t * static_cast<float>(width_px - 1)) - width * i / (kTicks - 1);
    image::draw_text(bar, {x, bar_px + kMarginPx}, text, dot, kInk);
  }
  image::draw_text(bar, {kMarginPx, bar_px + kMarginPx + line_px(dot)}, scale.what, dot, kInk);
  return bar;
}

Plane<Rgb8> false_color(const Plane<float>& values, const ColorScale& scale) {
  return image::false_color(values, scale.low, scale.high);
}

void outline(Plane<Rgb8>& picture, const Plane<std::uint8_t>& region, int thickness_px,
             Rgb8 color) {
  MACULA_CHECK(picture.rect() == region.rect(), "a region is of its picture");
  const auto outside = [&](int x, int y) { return region.contains(x, y) && region(x, y) == 0; };
  const auto touches = [&](int x, int y) {
    for (int k = 1; k <= thickness_px; ++k) {
      if (outside(x - k, y) || outside(x + k, y) || outside(x, y - k) || outside(x, y + k))
        return true;
    }
    return false;
  };
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      if (region(x, y) != 0 && touches(x, y)) picture(x, y) = color;
    }
  }
}

Plane<Rgb8> enlarged(const Plane<Rgb8>& picture, int factor, int width_px, int height_px) {
  MACULA_CHECK(
      factor >= 1 && picture.width() * factor >= width_px && picture.height() * factor >= height_px,
      "an enlarged picture covers its size");
  Plane<Rgb8> large(width_px, height_px);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) large(x, y) = picture(x / factor, y / factor);
  }
  return large;
}

Plane<Rgb8> drawn(const FigureSheet& sheet) {
  MACULA_CHECK(!sheet.panels.empty(), "a sheet shows something");
  const int panel_px = sheet.panels.front().picture.width();
  std::vector<Plane<Rgb8>> tiles;
  for (const Panel& panel : sheet.panels) tiles.push_back(captioned(panel.picture, panel.lines));
  const Plane<Rgb8> rows = image::contact_sheet(tiles, sheet.columns, panel_px);
  std::vector<Plane<Rgb8>> parts{
      lettered(rows.width(), std::span(&sheet.title, 1), dot_px(panel_px)), rows};
  for (const ColorScale& scale : sheet.scales) parts.push_back(scale_bar(scale, rows.width()));
  return image::contact_sheet(parts, 1, rows.width());
}

}  // namespace macula::bench
