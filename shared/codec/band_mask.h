// Which cells a second layer has something for: a bit a cell, each row by its difference from the
// one above, packed. Bands follow silhouettes, so differences are few. Thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/base/result.h"
#include "shared/image/plane.h"

namespace macula::codec {

/// 1 or 0 each.
using Mask = image::Plane<std::uint8_t>;

/// At most 65535 cells a side.
std::vector<std::byte> encode_mask(const Mask& mask);
/// `mask` must already have its size. An Error when the bytes are damaged or belong to another
/// size; the contents are then unspecified.
Result<void> decode_mask(std::span<const std::byte> bytes, Mask& mask);

}  // namespace macula::codec
