// Scratch: memory a thread works in and keeps for the next picture. Contents are not initialised.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

namespace macula::codec {

template <class T>
class Scratch {
 public:
  /// `count` elements, valid until the next call; earlier contents are lost.
  std::span<T> take(std::size_t count) {
    if (count > capacity_) {
      elements_ = std::make_unique_for_overwrite<T[]>(count);
      capacity_ = count;
    }
    return {elements_.get(), count};
  }

 private:
  std::unique_ptr<T[]> elements_;
  std::size_t capacity_ = 0;
};

}  // namespace macula::codec
