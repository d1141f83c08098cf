// Plane<T>: a rectangular array of pixels, row-major, top row first, contiguous. A value: copies copy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/base/check.h"

namespace macula::image {

struct Pixel {
  int x = 0, y = 0;
};

/// Half-open: covers [x, x + width) x [y, y + height).
struct Rect {
  int x = 0, y = 0, width = 0, height = 0;
  friend bool operator==(const Rect&, const Rect&) = default;
};

template <class T>
class Plane {
 public:
  Plane() = default;
  Plane(int width, int height, T value = T{})
      : width_(width), height_(height), pixels_(checked_count(width, height), value) {}

  int width() const { return width_; }
  int height() const { return height_; }
  bool empty() const { return pixels_.empty(); }
  Rect rect() const { return {0, 0, width_, height_}; }
  std::size_t size() const { return pixels_.size(); }
  T* data() { return pixels_.data(); }
  const T* data() const { return pixels_.data(); }
  std::span<T> pixels() { return pixels_; }
  std::span<const T> pixels() const { return pixels_; }

  T& operator()(int x, int y) {
    MACULA_DCHECK(contains(x, y));
    return pixels_[index(x, y)];
  }
  const T& operator()(int x, int y) const {
    MACULA_DCHECK(contains(x, y));
    return pixels_[index(x, y)];
  }
  std::span<T> row(int y) { return {pixels_.data() + index(0, y), static_cast<std::size_t>(width_)}; }
  std::span<const T> row(int y) const {
    return {pixels_.data() + index(0, y), static_cast<std::size_t>(width_)};
  }
  bool contains(int x, int y) const { return x >= 0 && x < width_ && y >= 0 && y < height_; }
  /// New size; old contents are lost. Keeps the memory when it suffices.
  void resize(int width, int height, T value = T{}) {
    pixels_.assign(checked_count(width, height), value);
    width_ = width;
    height_ = height;
  }

 private:
  static std::size_t checked_count(int width, int height) {
    MACULA_CHECK(width >= 0 && height >= 0, "a plane has no negative size");
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }

  int width_ = 0, height_ = 0;
  std::vector<T> pixels_;
};

}  // namespace macula::image
