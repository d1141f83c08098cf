#include "shared/codec/color.h"

#include "shared/base/text.h"
#include "shared/codec/jpeg.h"
#include "shared/codec/lossless.h"

namespace macula::codec {
namespace {

using base::bad_input;
using base::concat;

/// Rectangles to decode into come from the other end of a wire, so this is no MACULA_CHECK.
Result<void> check_rect(const image::Plane<Rgb8>& picture, const image::Rect& rect) {
  const bool inside = rect.x >= 0 && rect.y >= 0 && rect.width > 0 && rect.height > 0 &&
                      rect.width <= picture.width() - rect.x &&
                      rect.height <= picture.height() - rect.y;
  if (inside) return {};
  return bad_input(
      concat("rectangle ", rect.width, " x ", rect.height, " at (", rect.x, ", ", rect.y, ")"),
      "colour slice", concat("some pixels inside ", picture.width(), " x ", picture.height()));
}

}  // namespace

Result<Bytes> encode_color(const image::Plane<Rgb8>& picture, const image::Rect& rect,
                           const ColorOptions& options) {
  if (auto ok = check_rect(picture, rect); !ok) return base::forward(ok);
  if (options.codec == ColorCodec::Lossless) return encode_lossless(picture, rect);
  if (options.jpeg_quality < 1 || options.jpeg_quality > 100)
    return bad_input(concat("quality ", options.jpeg_quality), "JPEG", "1 to 100");
  return encode_jpeg(picture, rect, options.jpeg_quality, options.chroma);
}

Result<void> decode_color(std::span<const std::byte> bytes, ColorCodec codec,
                          const image::Rect& rect, image::Plane<Rgb8>& picture) {
  if (auto ok = check_rect(picture, rect); !ok) return ok;
  return codec == ColorCodec::Lossless ? decode_lossless(bytes, rect, picture)
                                       : decode_jpeg(bytes, rect, picture);
}

}  // namespace macula::codec
