// 8-bit RGB <-> YCbCr 4:2:0 planes, BT.709 at full range (ITU-R BT.709-6, 3.2 to 3.4; chroma sits
// in the middle of its four pixels and is their mean, and spreads over them again), two rows at a
// time, in vectors. Internal to this room. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>

#include "shared/image/color.h"

namespace macula::codec {

/// Rows are whole vectors: every pointer has room for a multiple of this many pixels.
inline constexpr std::size_t kYuvRowPixels = 64;

/// `width` pixels, a multiple of kYuvRowPixels; chroma rows are half as wide.
void rows_to_yuv(const Rgb8* upper, const Rgb8* lower, std::size_t width, std::uint8_t* y_upper,
                 std::uint8_t* y_lower, std::uint8_t* u, std::uint8_t* v);
void row_from_yuv(const std::uint8_t* y, const std::uint8_t* u, const std::uint8_t* v,
                  std::size_t width, Rgb8* row);

}  // namespace macula::codec
