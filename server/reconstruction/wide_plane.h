// WidePlane: floats by rows, each with idle cells to its left and right, so that whole vectors may
// read beyond a picture's sides. Idle cells are 0 unless a loop over vectors wrote there. A plane
// may hold some rows of its picture only; the others are not to be touched.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace macula::reconstruction {

class WidePlane {
 public:
  /// Cells on either side: the farthest tap of a filter, and a vector.
  static constexpr int kMargin = 64;

  /// All 0.
  void resize(int width, int height) { resize(width, height, 0, height); }
  /// Rows from `first` to before `end` alone.
  void resize(int width, int height, int first, int end) {
    width_ = width, height_ = height, first_ = first, end_ = std::max(first, end);
    stride_ = (width + 2 * kMargin + 15) / 16 * 16;
    cells_.assign(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(end_ - first_),
                  0.0F);
  }
  /// As large as another, the same rows.
  void resize_as(const WidePlane& other) {
    resize(other.width_, other.height_, other.first_, other.end_);
  }
  /// Holds these rows, too; what it held stays.
  void widen(int first, int end) {
    if (first >= end || (first >= first_ && end <= end_)) return;
    WidePlane wider;
    wider.resize(width_, height_, std::min(first, first_), std::max(end, end_));
    std::ranges::copy(
        cells_, wider.cells_.begin() +
                    static_cast<std::ptrdiff_t>(static_cast<std::size_t>(stride_) *
                                                static_cast<std::size_t>(first_ - wider.first_)));
    *this = std::move(wider);
  }
  int first_row() const { return first_; }
  int end_row() const { return end_; }
  bool empty() const { return cells_.empty(); }
  int width() const { return width_; }
  int height() const { return height_; }
  /// Cell 0 of a row.
  float* row(int y) { return cells_.data() + index(y); }
  const float* row(int y) const { return cells_.data() + index(y); }

 private:
  std::size_t index(int y) const {
    return static_cast<std::size_t>(y - first_) * static_cast<std::size_t>(stride_) + kMargin;
  }

  int width_ = 0, height_ = 0, stride_ = 0;
  int first_ = 0, end_ = 0;
  std::vector<float> cells_;
};

}  // namespace macula::reconstruction
