// WidePlane: floats by rows, each with idle cells to its left and right, so that whole vectors may
// read beyond a picture's sides. Idle cells are 0 unless a loop over vectors wrote there.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace macula::reconstruction {

class WidePlane {
 public:
  /// Cells on either side: the farthest tap of a filter, and a vector.
  static constexpr int kMargin = 64;

  /// All 0.
  void resize(int width, int height) {
    width_ = width, height_ = height;
    stride_ = (width + 2 * kMargin + 15) / 16 * 16;
    cells_.assign(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(height), 0.0F);
  }
  bool empty() const { return cells_.empty(); }
  int width() const { return width_; }
  int height() const { return height_; }
  /// Cell 0 of a row.
  float* row(int y) { return cells_.data() + index(y); }
  const float* row(int y) const { return cells_.data() + index(y); }

 private:
  std::size_t index(int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(stride_) + kMargin;
  }

  int width_ = 0, height_ = 0, stride_ = 0;
  std::vector<float> cells_;
};

}  // namespace macula::reconstruction
