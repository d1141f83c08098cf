#include "shared/codec/lossless.h"

#include <algorithm>
#include <array>
#include <utility>

#include "shared/base/text.h"
#include "shared/codec/packed.h"

namespace macula::codec {
namespace {

constexpr std::size_t kChannels = 3;

/// One row as three separate channels, each with one sample before its first: the left neighbour of
/// the first pixel, which is taken to equal the one above it.
class Row {
 public:
  explicit Row(int width) {
    for (auto& channel : channels_) channel.assign(static_cast<std::size_t>(width) + 1, 0);
  }
  std::uint8_t* operator[](std::size_t channel) { return channels_[channel].data() + 1; }
  void set_left_border(Row& above) {
    for (std::size_t c = 0; c < kChannels; ++c) (*this)[c][-1] = above[c][0];
  }

 private:
  std::array<std::vector<std::uint8_t>, kChannels> channels_;
};

std::uint8_t wrap(int value) {
  return static_cast<std::uint8_t>(value);
}

/// The median of left, above and left + above - corner.
inline int predict(int left, int above, int corner) {
  const int low = std::min(left, above), high = std::max(left, above);
  return std::max(low, std::min(high, left + above - corner));
}

void split(std::span<const Rgb8> pixels, Row& row) {
  std::uint8_t *green = row[0], *red = row[1], *blue = row[2];
  for (std::size_t x = 0; x < pixels.size(); ++x) {
    green[x] = pixels[x].g;
    red[x] = wrap(pixels[x].r - pixels[x].g);
    blue[x] = wrap(pixels[x].b - pixels[x].g);
  }
}

void join(Row& row, std::span<Rgb8> pixels) {
  const std::uint8_t *green = row[0], *red = row[1], *blue = row[2];
  for (std::size_t x = 0; x < pixels.size(); ++x)
    pixels[x] = {wrap(red[x] + green[x]), green[x], wrap(blue[x] + green[x])};
}

void predict_row(const std::uint8_t* row, const std::uint8_t* above,
                 std::span<std::uint8_t> residuals) {
  for (std::size_t x = 0; x < residuals.size(); ++x)
    residuals[x] = wrap(row[x] - predict(*(row + x - 1), above[x], *(above + x - 1)));
}

/// Three channels side by side, because each sample waits for the one to its left.
void restore_row(std::array<const std::uint8_t*, kChannels> residuals, Row& above, Row& row,
                 int width) {
  const std::array above_of{above[0], above[1], above[2]};
  const std::array row_of{row[0], row[1], row[2]};
  for (int x = 0; x < width; ++x)
    for (std::size_t c = 0; c < kChannels; ++c)
      row_of[c][x] =
          wrap(residuals[c][x] + predict(row_of[c][x - 1], above_of[c][x], above_of[c][x - 1]));
}

/// Residuals lie channel by channel, row by row.
struct ResidualLayout {
  explicit ResidualLayout(const image::Rect& rect)
      : width(static_cast<std::size_t>(rect.width)),
        height(static_cast<std::size_t>(rect.height)) {}
  std::size_t bytes() const { return kChannels * width * height; }
  std::size_t at(std::size_t channel, int y) const {
    return (channel * height + static_cast<std::size_t>(y)) * width;
  }
  std::size_t width, height;
};

}  // namespace

Result<Bytes> encode_lossless(const image::Plane<Rgb8>& picture, const image::Rect& rect) {
  static thread_local Scratch<std::uint8_t> memory;
  if (rect.width > kMaxPackedSide || rect.height > kMaxPackedSide)
    return base::bad_input(base::concat(rect.width, " x ", rect.height, " px are too many"),
                           "lossless colour", "at most 65535 a side");
  const ResidualLayout layout(rect);
  const auto residuals = memory.take(layout.bytes());
  Row above(rect.width), row(rect.width);
  for (int y = 0; y < rect.height; ++y) {
    split(picture.row(rect.y + y).subspan(static_cast<std::size_t>(rect.x), layout.width), row);
    row.set_left_border(above);
    for (std::size_t c = 0; c < kChannels; ++c)
      predict_row(row[c], above[c], residuals.subspan(layout.at(c, y), layout.width));
    std::swap(above, row);
  }
  return pack({rect.width, rect.height}, residuals);
}

Result<void> decode_lossless(std::span<const std::byte> bytes, const image::Rect& rect,
                             image::Plane<Rgb8>& picture) {
  static thread_local Scratch<std::uint8_t> memory;
  const ResidualLayout layout(rect);
  const auto residuals = unpack(bytes, {rect.width, rect.height}, layout.bytes(), memory);
  if (!residuals) return base::forward(residuals);
  Row above(rect.width), row(rect.width);
  for (int y = 0; y < rect.height; ++y) {
    row.set_left_border(above);
    const auto of = [&](std::size_t channel) { return residuals->data() + layout.at(channel, y); };
    restore_row({of(0), of(1), of(2)}, above, row, rect.width);
    join(row, picture.row(rect.y + y).subspan(static_cast<std::size_t>(rect.x), layout.width));
    std::swap(above, row);
  }
  return {};
}

}  // namespace macula::codec
