#include "shared/codec/tiles.h"

namespace macula::codec {
namespace {

bool holds_any(const Mask& mask, int x, int y) {
  const int end_y = std::min(y + Tiles::kSide, mask.height());
  const auto count = static_cast<std::size_t>(std::min(Tiles::kSide, mask.width() - x));
  for (; y < end_y; ++y) {
    const auto some = mask.row(y).subspan(static_cast<std::size_t>(x), count);
    if (std::any_of(some.begin(), some.end(), [](std::uint8_t bit) { return bit != 0; })) {
      return true;
    }
  }
  return false;
}

}  // namespace

Tiles::Tiles(const Mask& mask) {
  for (int y = 0; y < mask.height(); y += kSide) {
    for (int x = 0; x < mask.width(); x += kSide) {
      if (holds_any(mask, x, y)) places_.push_back({x, y});
    }
  }
  const int across = (mask.width() + kSide - 1) / kSide;
  columns_ = std::min(across, static_cast<int>(places_.size()));
}

int Tiles::height() const {
  if (places_.empty()) return 0;
  return (static_cast<int>(places_.size()) + columns_ - 1) / columns_ * kSide;
}

}  // namespace macula::codec
