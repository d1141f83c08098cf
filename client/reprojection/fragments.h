// Fragments: what stands before the display's pixels, worked on one band of rows at a time, so that
// it stays in the second-level cache: where colours come from is kept for the band alone, inverse
// depth for the whole picture (holes are filled last). Planes of floats whose rows may be read and
// written a whole vector beyond their end. Reused from frame to frame. Internal to this room.
#pragma once

#include <algorithm>
#include <cstddef>

#include "shared/base/big_vector.h"

namespace macula::reprojection {

struct Fragment {
  float inverse_depth = -1.0F;  ///< 1/m; -1: nothing drawn yet; infinity itself is 0
  float u = 0.0F, v = 0.0F;     ///< cell coordinates, cell (i, j)'s centre at exactly (i, j)
  bool drawn() const { return inverse_depth >= 0.0F; }
};

/// A row of fragments, readable a whole vector beyond its end.
struct FragmentRow {
  const float *inverse_depth, *u, *v;
};

class Fragments {
 public:
  Fragments() = default;
  /// One band that is the whole picture.
  Fragments(int width, int height) {
    resize(width, height);
    begin_band(0, height);
  }

  void resize(int width, int height) {
    width_ = width, height_ = height;
    stride_ = static_cast<std::size_t>(width) + kBeyond;
    inverse_depth_.resize(stride_ * static_cast<std::size_t>(height));
  }
  /// From here on only rows [first, end) are drawn to; nothing is drawn there yet.
  void begin_band(int first, int end) {
    first_row_ = first, end_row_ = end;
    const std::size_t count = stride_ * static_cast<std::size_t>(end - first);
    u_.resize(std::max(count, u_.size()));
    v_.resize(std::max(count, v_.size()));
    const auto begin = inverse_depth_.begin() + static_cast<std::ptrdiff_t>(row_begin(first));
    std::fill_n(begin, count, -1.0F);
  }

  int width() const { return width_; }
  int height() const { return height_; }
  int first_row() const { return first_row_; }
  int end_row() const { return end_row_; }
  bool contains(int x, int y) const { return x >= 0 && x < width_ && y >= 0 && y < height_; }
  float inverse_depth(int x, int y) const { return inverse_depths(y)[x]; }
  bool drawn(int x, int y) const { return inverse_depth(x, y) >= 0.0F; }

  float* inverse_depths(int y) { return inverse_depth_.data() + row_begin(y); }
  const float* inverse_depths(int y) const { return inverse_depth_.data() + row_begin(y); }
  /// Of a row of the band.
  float* us(int y) { return u_.data() + row_begin(y - first_row_); }
  float* vs(int y) { return v_.data() + row_begin(y - first_row_); }
  const float* us(int y) const { return u_.data() + row_begin(y - first_row_); }
  const float* vs(int y) const { return v_.data() + row_begin(y - first_row_); }

  /// A row of the band.
  FragmentRow row(int y) const { return {inverse_depths(y), us(y), vs(y)}; }
  /// In a picture twice as high: the row of fragments that lies next to row `y` of pixels after its
  /// own, y / 2, which stands for it at the band's first and last.
  int row_beside(int y) const {
    return std::clamp(y % 2 == 0 ? y / 2 - 1 : y / 2 + 1, first_row_, end_row_ - 1);
  }

  /// A pixel of the band.
  Fragment operator()(int x, int y) const { return {inverse_depth(x, y), us(y)[x], vs(y)[x]}; }
  void set(int x, int y, const Fragment& fragment) {
    inverse_depths(y)[x] = fragment.inverse_depth;
    us(y)[x] = fragment.u;
    vs(y)[x] = fragment.v;
  }

 private:
  static constexpr std::size_t kBeyond = 16;  ///< floats: the widest vector
  std::size_t row_begin(int row) const { return stride_ * static_cast<std::size_t>(row); }

  int width_ = 0, height_ = 0, first_row_ = 0, end_row_ = 0;
  std::size_t stride_ = 0;
  base::BigVector<float> inverse_depth_, u_, v_;
};

}  // namespace macula::reprojection
