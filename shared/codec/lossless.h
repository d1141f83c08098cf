// Lossless colour: green, red - green and blue - green, each predicted by the median of left, above
// and their plane (LOCO-I: Weinberger, Seroussi, Sapiro 2000), packed as three planes of residuals.
// Internal to this room; color.h is the door and has checked the rectangle. Thread-safe.
#pragma once

#include "shared/codec/color.h"

namespace macula::codec {

Result<Bytes> encode_lossless(const image::Plane<Rgb8>& picture, const image::Rect& rect);
Result<void> decode_lossless(std::span<const std::byte> bytes, const image::Rect& rect,
                             image::Plane<Rgb8>& picture);

}  // namespace macula::codec
