// Tiles: a sparse picture packed into a dense one, the atlas. Of a mask's 16x16 tiles those that
// hold something stand side by side in the order of rows; both ends know them from the mask.
#pragma once

#include <algorithm>
#include <vector>

#include "shared/codec/band_mask.h"

namespace macula::codec {

class Tiles {
 public:
  static constexpr int kSide = 16;  ///< cells: two JPEG blocks, one of halved colour

  explicit Tiles(const Mask& mask);

  bool empty() const { return places_.empty(); }
  std::size_t count() const { return places_.size(); }
  /// Of the atlas, in cells: whole tiles, about as wide as the picture.
  int width() const { return columns_ * kSide; }
  int height() const;

  /// Of the mask's size -> the atlas. What of a tile lies beyond the picture repeats its border.
  template <class T>
  image::Plane<T> packed(const image::Plane<T>& whole) const {
    image::Plane<T> atlas(width(), height());
    for_each_row([&](int x, int y, int at_x, int at_y) {
      const auto from = whole.row(std::min(y, whole.height() - 1));
      for (int i = 0; i < kSide; ++i) {
        atlas(at_x + i, at_y) = from[std::min(x + i, whole.width() - 1)];
      }
    });
    return atlas;
  }
  /// The atlas -> the tiles of `whole`, of the mask's size; the rest stays as it is.
  template <class T>
  void unpack(const image::Plane<T>& atlas, image::Plane<T>& whole) const {
    for_each_row([&](int x, int y, int at_x, int at_y) {
      if (y >= whole.height()) return;
      const int count = std::min(kSide, whole.width() - x);
      std::copy_n(&atlas(at_x, at_y), count, &whole(x, y));
    });
  }

 private:
  /// row(x, y, atlas_x, atlas_y): where rows of tiles begin, in the picture and in the atlas.
  template <class Row>
  void for_each_row(Row row) const {
    for (std::size_t tile = 0; tile < places_.size(); ++tile) {
      const int at_x = static_cast<int>(tile) % columns_ * kSide;
      const int at_y = static_cast<int>(tile) / columns_ * kSide;
      for (int j = 0; j < kSide; ++j) row(places_[tile].x, places_[tile].y + j, at_x, at_y + j);
    }
  }

  std::vector<image::Pixel> places_;  ///< upper left cells
  int columns_ = 0;                   ///< of tiles in the atlas
};

/// In an atlas: cells outside its mask, packed alike, take the value of the nearest one inside it
/// to their left or right within their tile, then of the row above or below: nothing breaks within
/// a tile, which lossy codecs like.
template <class T>
void fill_tiles(Mask mask, image::Plane<T>& atlas) {
  constexpr int kSide = Tiles::kSide;
  const auto take = [&](int x, int y, int from_x, int from_y) {
    if (mask(x, y) != 0 || mask(from_x, from_y) == 0) return;
    atlas(x, y) = atlas(from_x, from_y);
    mask(x, y) = 1;
  };
  for (int y = 0; y < atlas.height(); ++y) {
    for (int x = 0; x < atlas.width(); ++x) {
      if (x % kSide != 0) take(x, y, x - 1, y);
    }
    for (int x = atlas.width() - 1; x >= 0; --x) {
      if (x % kSide != kSide - 1) take(x, y, x + 1, y);
    }
  }
  for (int y = 0; y < atlas.height(); ++y) {
    for (int x = 0; x < atlas.width(); ++x) {
      if (y % kSide != 0) take(x, y, x, y - 1);
    }
  }
  for (int y = atlas.height() - 1; y >= 0; --y) {
    for (int x = 0; x < atlas.width(); ++x) {
      if (y % kSide != kSide - 1) take(x, y, x, y + 1);
    }
  }
}

}  // namespace macula::codec
