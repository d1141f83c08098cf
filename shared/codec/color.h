// Colour pictures <-> bytes, a rectangle at a time. Jpeg is stateless (libjpeg-turbo): any frame
// may be dropped, gaze may jump. Lossless is zstd over predicted rows, bit-exact. Decoding checks
// the coded size against the expected rectangle before it allocates.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "shared/base/result.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::codec {

enum class ColorCodec { Jpeg, Lossless };
enum class Chroma { Full, Half };  ///< 4:4:4 or 4:2:0

struct ColorOptions {
  ColorCodec codec = ColorCodec::Jpeg;
  int jpeg_quality = 85;  ///< 1..100
  Chroma chroma = Chroma::Half;
};

using Bytes = std::vector<std::byte>;

/// Encodes `rect` of `picture`. An Error when it is empty or not inside the picture, has more than
/// 65535 pixels a side, or the quality is out of range. Thread-safe, like decoding.
Result<Bytes> encode_color(const image::Plane<Rgb8>& picture, const image::Rect& rect,
                           const ColorOptions& options);
/// Decodes into `rect` of `picture`, which must already have its size. An Error when the bytes are
/// damaged or belong to another size; the rectangle's contents are then unspecified, nothing else
/// is touched.
Result<void> decode_color(std::span<const std::byte> bytes, ColorCodec codec,
                          const image::Rect& rect, image::Plane<Rgb8>& picture);

}  // namespace macula::codec
