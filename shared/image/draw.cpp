#include "shared/image/draw.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/image/tone.h"

namespace macula::image {
namespace {

constexpr int kGapPx = 4;
constexpr Rgb8 kMagenta{255, 0, 255};

/// Oklab (Ottosson 2020) -> display encoding.
Rgb8 encode_oklab(float lightness, float a, float b) {
  const auto cube = [](float v) { return v * v * v; };
  const float l = cube(lightness + 0.3963377774F * a + 0.2158037573F * b);
  const float m = cube(lightness - 0.1055613458F * a - 0.0638541728F * b);
  const float s = cube(lightness - 0.0894841775F * a - 1.2914855480F * b);
  return encode(Tone{}, Rgb{4.0767416621F * l - 3.3077115913F * m + 0.2309699292F * s,
                            -1.2684380046F * l + 2.6097574011F * m - 0.3413193965F * s,
                            -0.0041960863F * l - 0.7034186147F * m + 1.7076147010F * s});
}

/// Lightness rises in equal steps, the hue goes from blue by green to yellow.
std::array<Rgb8, 256> make_ramp() {
  std::array<Rgb8, 256> ramp{};
  for (std::size_t i = 0; i < ramp.size(); ++i) {
    const float t = static_cast<float>(i) / 255.0F;
    const float bend = 4.0F * t * (1.0F - t);
    ramp[i] = encode_oklab(std::lerp(0.24F, 0.93F, t), std::lerp(0.0F, -0.03F, t) - 0.07F * bend,
                           std::lerp(-0.13F, 0.17F, t));
  }
  return ramp;
}

/// The part of source cells [0, from) that output cell `index` of `to` covers: first cell, and the
/// weight of each (they sum to 1).
struct BoxTap {
  int first = 0;
  std::vector<float> weights;
};

std::vector<BoxTap> make_box_taps(int from, int to) {
  std::vector<BoxTap> taps(static_cast<std::size_t>(to));
  const double step = static_cast<double>(from) / to;
  for (int i = 0; i < to; ++i) {
    const double begin = i * step;
    const double end = std::min<double>((i + 1) * step, from);
    auto& tap = taps[static_cast<std::size_t>(i)];
    tap.first = static_cast<int>(begin);
    for (int cell = tap.first; cell < end; ++cell)
      tap.weights.push_back(static_cast<float>(
          (std::min<double>(cell + 1, end) - std::max<double>(cell, begin)) / (end - begin)));
  }
  return taps;
}

/// Averages `count` rows of `linear` from `first` on into one row.
std::vector<Rgb> average_rows(const Plane<Rgb>& linear, const BoxTap& tap) {
  std::vector<Rgb> row(static_cast<std::size_t>(linear.width()), Rgb{0.0F});
  for (std::size_t k = 0; k < tap.weights.size(); ++k) {
    const auto source = linear.row(tap.first + static_cast<int>(k));
    for (std::size_t x = 0; x < row.size(); ++x) row[x] += tap.weights[k] * source[x];
  }
  return row;
}

Rgb average_cells(const std::vector<Rgb>& row, const BoxTap& tap) {
  Rgb sum{0.0F};
  for (std::size_t k = 0; k < tap.weights.size(); ++k)
    sum += tap.weights[k] * row[static_cast<std::size_t>(tap.first) + k];
  return sum;
}

/// Where each tile of a sheet goes, and the sheet's size.
struct SheetLayout {
  std::vector<Pixel> corners;
  int width = 0, height = 0;
};

SheetLayout lay_out(const std::vector<Plane<Rgb8>>& tiles, int columns, int tile_width_px) {
  SheetLayout layout;
  layout.width = columns * tile_width_px + (columns - 1) * kGapPx;
  int top = 0, row_height = 0;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const int column = static_cast<int>(i) % columns;
    if (column == 0 && i > 0) {
      top += row_height + kGapPx;
      row_height = 0;
    }
    layout.corners.push_back({column * (tile_width_px + kGapPx), top});
    row_height = std::max(row_height, tiles[i].height());
  }
  layout.height = top + row_height;
  return layout;
}

void paste(const Plane<Rgb8>& tile, Pixel corner, Plane<Rgb8>& sheet) {
  for (int y = 0; y < tile.height(); ++y)
    std::copy(tile.row(y).begin(), tile.row(y).end(), sheet.row(corner.y + y).begin() + corner.x);
}

}  // namespace

Rgb8 false_color(float t) {
  static const auto kRamp = make_ramp();
  if (std::isnan(t)) return kMagenta;
  return kRamp[static_cast<std::size_t>(std::clamp(t, 0.0F, 1.0F) * 255.0F + 0.5F)];
}

Plane<Rgb8> false_color(const Plane<float>& values, float low, float high) {
  MACULA_CHECK(low < high, "a false-colour range runs upwards");
  Plane<Rgb8> out(values.width(), values.height());
  std::transform(values.pixels().begin(), values.pixels().end(), out.pixels().begin(),
                 [=](float value) { return false_color((value - low) / (high - low)); });
  return out;
}

Plane<Rgb8> downscale(const Plane<Rgb8>& picture, int width_px) {
  MACULA_CHECK(width_px > 0, "a picture is at least one pixel wide");
  if (picture.empty() || picture.width() <= width_px) return picture;
  const double scale = static_cast<double>(width_px) / picture.width();
  const int height_px = std::max(1, static_cast<int>(std::lround(picture.height() * scale)));
  const auto columns = make_box_taps(picture.width(), width_px);
  const auto rows = make_box_taps(picture.height(), height_px);
  const auto linear = decode_display_linear(picture);
  Plane<Rgb> shrunk(width_px, height_px);
  for (int y = 0; y < height_px; ++y) {
    const auto averaged = average_rows(linear, rows[static_cast<std::size_t>(y)]);
    std::transform(columns.begin(), columns.end(), shrunk.row(y).begin(),
                   [&](const BoxTap& tap) { return average_cells(averaged, tap); });
  }
  Plane<Rgb8> out;
  encode(Tone{}, shrunk, out);
  return out;
}

Plane<Rgb8> contact_sheet(const std::vector<Plane<Rgb8>>& pictures, int columns,
                          int tile_width_px) {
  MACULA_CHECK(columns > 0 && tile_width_px > 0, "a sheet has columns of some width");
  if (pictures.empty()) return {};
  std::vector<Plane<Rgb8>> tiles;
  tiles.reserve(pictures.size());
  for (const auto& picture : pictures) tiles.push_back(downscale(picture, tile_width_px));
  const int used_columns = std::min(columns, static_cast<int>(tiles.size()));
  const auto layout = lay_out(tiles, used_columns, tile_width_px);
  Plane<Rgb8> sheet(layout.width, layout.height);
  for (std::size_t i = 0; i < tiles.size(); ++i) paste(tiles[i], layout.corners[i], sheet);
  return sheet;
}

void draw_cross(Plane<Rgb8>& picture, Pixel centre, int arm_px, Rgb8 color) {
  for (int step = -arm_px; step <= arm_px; ++step) {
    if (picture.contains(centre.x + step, centre.y)) picture(centre.x + step, centre.y) = color;
    if (picture.contains(centre.x, centre.y + step)) picture(centre.x, centre.y + step) = color;
  }
}

}  // namespace macula::image
