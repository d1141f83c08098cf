// Filtered samples <-> bytes: width and height (16 bits each, little-endian), then one zstd frame
// of level 1 with its content size and a checksum. Internal to this room. Thread-safe: zstd's
// contexts belong to the calling thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/base/result.h"
#include "shared/codec/scratch.h"

namespace macula::codec {

inline constexpr int kMaxPackedSide = 65535;

/// Width and height in samples, at most kMaxPackedSide each.
struct PackedSize {
  int width = 0, height = 0;
};

std::vector<std::byte> pack(PackedSize size, std::span<const std::uint8_t> samples);

/// The size that packed bytes claim; nullopt when they are too few to claim any.
std::optional<PackedSize> packed_size(std::span<const std::byte> bytes);

/// Unpacks exactly `count` bytes into `memory`. What the bytes claim is compared with `size` and
/// `count` before anything is allocated; an Error for every other kind of damage.
Result<std::span<const std::uint8_t>> unpack(std::span<const std::byte> bytes, PackedSize size,
                                             std::size_t count, Scratch<std::uint8_t>& memory);

}  // namespace macula::codec
