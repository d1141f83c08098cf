// Parcel: values on their way from one process to others of the same program on machines of the
// same kind, or back out of such a message. One description serves both ways: `parcel.value(x)`
// writes x while packing and sets it while unpacking. Bytes are as in memory. A message that is
// shorter than its description is our bug.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "server/scheduling/bytes.h"
#include "shared/base/check.h"
#include "shared/image/plane.h"

namespace macula::scheduling {

class Parcel {
 public:
  /// Appends to `to`, which must outlive the parcel.
  static Parcel packing(Bytes& to) { return Parcel(&to, nullptr, {}); }
  static Parcel unpacking(std::span<const std::byte> from) {
    return Parcel(nullptr, nullptr, from);
  }
  /// Adds up what packing would append to.
  static Parcel weighing(std::size_t& bytes) { return Parcel(nullptr, &bytes, {}); }

  bool unpacks() const { return to_ == nullptr && weight_ == nullptr; }
  /// Bytes that no unpacking took yet.
  std::size_t left() const { return from_.size(); }

  template <class T>
  void value(T& value) {
    values(std::span<T>(&value, 1));
  }
  template <class T>
  void values(std::span<T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    move(values.data(), values.size_bytes());
  }
  /// Its length travels with it.
  template <class T>
  void vector(std::vector<T>& values) {
    auto count = values.size();
    value(count);
    if (unpacks()) values.resize(count);
    this->values(std::span<T>(values));
  }
  /// The part of a plane; empty planes have none.
  template <class T>
  void rect(image::Plane<T>& plane, const image::Rect& rect) {
    if (plane.empty()) return;
    for (int y = rect.y; y < rect.y + rect.height; ++y) {
      values(plane.row(y).subspan(static_cast<std::size_t>(rect.x),
                                  static_cast<std::size_t>(rect.width)));
    }
  }
  /// Cells from anywhere in a plane; empty planes have none.
  template <class T>
  void cells(image::Plane<T>& plane, std::span<const image::Pixel> cells) {
    if (plane.empty()) return;
    const std::size_t bytes = sizeof(T) * cells.size();
    if (weight_ != nullptr) {
      *weight_ += bytes;
    } else if (to_ != nullptr) {
      std::byte* at = append(bytes);
      for (const image::Pixel& cell : cells) {
        std::memcpy(at, &plane(cell.x, cell.y), sizeof(T));
        at += sizeof(T);
      }
    } else {
      const std::byte* at = take(bytes);
      for (const image::Pixel& cell : cells) {
        std::memcpy(&plane(cell.x, cell.y), at, sizeof(T));
        at += sizeof(T);
      }
    }
  }

 private:
  Parcel(Bytes* to, std::size_t* weight, std::span<const std::byte> from)
      : to_(to), weight_(weight), from_(from) {}

  std::byte* append(std::size_t bytes) {
    const std::size_t before = to_->size();
    to_->resize(before + bytes);
    return to_->data() + before;
  }
  const std::byte* take(std::size_t bytes) {
    MACULA_CHECK(bytes <= from_.size(), "a parcel holds what its description says");
    const std::byte* taken = from_.data();
    from_ = from_.subspan(bytes);
    return taken;
  }
  void move(void* memory, std::size_t bytes) {
    if (bytes == 0) return;
    if (weight_ != nullptr) {
      *weight_ += bytes;
      return;
    }
    if (to_ != nullptr) {
      std::memcpy(append(bytes), memory, bytes);
    } else {
      std::memcpy(memory, take(bytes), bytes);
    }
  }

  Bytes* to_;
  std::size_t* weight_;
  std::span<const std::byte> from_;
};

/// The cells of `rect` whose `mask` is `wanted`, row by row. Without branches: a mask is noise.
inline std::vector<image::Pixel> marked_cells(const image::Plane<std::uint8_t>& mask,
                                              const image::Rect& rect, std::uint8_t wanted) {
  std::vector<image::Pixel> cells(static_cast<std::size_t>(rect.width * rect.height) + 1);
  std::size_t count = 0;
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    const auto row = mask.row(y);
    for (int x = rect.x; x < rect.x + rect.width; ++x) {
      cells[count] = {x, y};
      count += row[static_cast<std::size_t>(x)] == wanted ? 1 : 0;
    }
  }
  cells.resize(count);
  return cells;
}

}  // namespace macula::scheduling
