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
  /// The cells of that part whose `mask`, of the plane's size, is `wanted`.
  template <class T>
  void masked(image::Plane<T>& plane, const image::Rect& rect,
              const image::Plane<std::uint8_t>& mask, std::uint8_t wanted) {
    if (plane.empty()) return;
    std::vector<T> some(static_cast<std::size_t>(rect.width) + 1);  // one more: see below
    for (int y = rect.y; y < rect.y + rect.height; ++y) {
      const auto begin = static_cast<std::size_t>(rect.x);
      masked_row(plane.row(y).data() + begin, mask.row(y).data() + begin, wanted, some);
    }
  }
  /// Cells from anywhere in a plane; empty planes have none.
  template <class T>
  void cells(image::Plane<T>& plane, std::span<const image::Pixel> cells) {
    if (plane.empty()) return;
    for (const image::Pixel& cell : cells) value(plane(cell.x, cell.y));
  }

 private:
  Parcel(Bytes* to, std::size_t* weight, std::span<const std::byte> from)
      : to_(to), weight_(weight), from_(from) {}

  /// Without branches: a mask is noise. What is not wanted goes where the next one goes.
  template <class T>
  void masked_row(T* cells, const std::uint8_t* mask, std::uint8_t wanted, std::vector<T>& some) {
    const std::size_t width = some.size() - 1;
    std::size_t count = 0;
    for (std::size_t x = 0; x < width; ++x) {
      some[count] = cells[x];
      count += mask[x] == wanted ? 1 : 0;
    }
    values(std::span<T>(some.data(), count));
    if (!unpacks()) return;
    for (std::size_t x = 0, next = 0; x < width; ++x) {
      const bool is_wanted = mask[x] == wanted;
      cells[x] = is_wanted ? some[next] : cells[x];
      next += is_wanted ? 1 : 0;
    }
  }

  void move(void* memory, std::size_t bytes) {
    if (bytes == 0) return;
    if (weight_ != nullptr) {
      *weight_ += bytes;
      return;
    }
    if (to_ != nullptr) {
      const std::size_t before = to_->size();
      to_->resize(before + bytes);
      std::memcpy(to_->data() + before, memory, bytes);
      return;
    }
    MACULA_CHECK(bytes <= from_.size(), "a parcel holds what its description says");
    std::memcpy(memory, from_.data(), bytes);
    from_ = from_.subspan(bytes);
  }

  Bytes* to_;
  std::size_t* weight_;
  std::span<const std::byte> from_;
};

}  // namespace macula::scheduling
