#include "server/scene/decode_image.h"

#include <algorithm>

#include "shared/base/text.h"
#include "shared/codec/jpeg_image.h"

namespace macula::scene {
namespace {

bool starts_with(std::span<const std::byte> bytes, std::initializer_list<int> magic) {
  return bytes.size() >= magic.size() &&
         std::equal(magic.begin(), magic.end(), bytes.begin(),
                    [](int expected, std::byte actual) { return std::byte(expected) == actual; });
}

image::Plane<image::Rgba8> with_alpha(const image::Plane<Rgb8>& picture) {
  image::Plane<image::Rgba8> result(picture.width(), picture.height());
  std::transform(picture.pixels().begin(), picture.pixels().end(), result.pixels().begin(),
                 [](const Rgb8& c) {
                   return image::Rgba8{c.r, c.g, c.b, 255};
                 });
  return result;
}

Result<image::Plane<image::Rgba8>> decode_one(std::span<const std::byte> bytes,
                                              const std::string& place) {
  if (starts_with(bytes, {0x89, 'P', 'N', 'G'}))
    return image::decode_png(bytes, place, kMaxImageSide);
  if (starts_with(bytes, {0xFF, 0xD8})) {
    return codec::decode_jpeg_image(bytes, place, kMaxImageSide).map(with_alpha);
  }
  return base::bad_input("neither PNG nor JPEG", place, "convert the image to PNG or JPEG");
}

}  // namespace

Result<image::Plane<image::Rgba8>> ImageDecoder::decode(std::span<const std::byte> bytes,
                                                        const std::string& place) {
  auto pixels = decode_one(bytes, place);
  if (!pixels) return pixels;
  pixels_ += pixels->size();
  bytes_ += bytes.size();
  const std::uint64_t allowed =
      std::min(kMaxImagePixels, kFreeImagePixels + kImagePixelsPerByte * bytes_);
  if (pixels_ <= allowed) return pixels;
  return base::bad_input(
      base::concat("the textures so far have ", pixels_, " pixels from ", bytes_, " bytes"), place,
      base::concat("at most ", kFreeImagePixels, " and ", kImagePixelsPerByte, " more a byte, and ",
                   kMaxImagePixels, " in all; scale them down"));
}

}  // namespace macula::scene
