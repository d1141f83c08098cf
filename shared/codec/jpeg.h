// JPEG by libjpeg-turbo: baseline YCbCr, 4:4:4 or 4:2:0. Internal to this room; color.h is the door
// and has checked the rectangle. Thread-safe: a thread has its own compressor and decompressor.
#pragma once

#include "shared/codec/color.h"

namespace macula::codec {

Result<Bytes> encode_jpeg(const image::Plane<Rgb8>& picture, const image::Rect& rect, int quality,
                          Chroma chroma);
Result<void> decode_jpeg(std::span<const std::byte> bytes, const image::Rect& rect,
                         image::Plane<Rgb8>& picture);

}  // namespace macula::codec
