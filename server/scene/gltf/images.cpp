#include "server/scene/gltf/images.h"

#include <algorithm>
#include <array>
#include <span>

#include "server/scene/gltf/accessor.h"
#include "shared/base/text.h"
#include "shared/codec/jpeg_image.h"

namespace macula::scene::gltf {
namespace {

using Encoded = std::span<const std::byte>;

bool starts_with(Encoded bytes, std::initializer_list<int> magic) {
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

/// The format is told by the first bytes: file names and MIME types lie.
Result<image::Plane<image::Rgba8>> decode(Encoded bytes, const std::string& place) {
  if (starts_with(bytes, {0x89, 'P', 'N', 'G'}))
    return image::decode_png(bytes, place, kMaxImageSide);
  if (starts_with(bytes, {0xFF, 0xD8})) {
    return codec::decode_jpeg_image(bytes, place, kMaxImageSide).map(with_alpha);
  }
  return base::bad_input("neither PNG nor JPEG", place, "convert the image to PNG or JPEG");
}

}  // namespace

Result<Index> ImageImporter::require(int image_index) {
  if (const auto known = imported_.find(image_index); known != imported_.end())
    return known->second;
  const tinygltf::Image* image = find(document_.model.images, image_index);
  if (!image) {
    return base::bad_input(base::concat("a texture names image ", image_index), document_.path,
                           base::concat("there are ", document_.model.images.size()));
  }
  std::string place = document_.place("image", static_cast<std::size_t>(image_index));
  Bytes file;
  Encoded encoded;
  if (const auto inlined = document_.inline_images.find(image_index);
      inlined != document_.inline_images.end()) {
    encoded = inlined->second;
  } else if (image->bufferView >= 0) {
    const auto bytes = buffer_view_bytes(document_, image->bufferView);
    if (!bytes) return forward(bytes);
    encoded = std::as_bytes(*bytes);
  } else {
    const auto path = document_.folder.resolve(percent_decoded(image->uri));
    if (!path) return base::bad_input(path.error().what, place, path.error().remedy);
    auto bytes = read_file(*path, kMaxImageFileBytes);
    if (!bytes) return forward(bytes);
    file = std::move(*bytes);
    encoded = file;
    place += " (" + image->uri + ")";
  }
  auto pixels = decode(encoded, place);
  if (!pixels) return forward(pixels);
  pixels_ += pixels->size();
  if (pixels_ > kMaxImagePixels) {
    return base::bad_input("the textures are too large together", place,
                           base::concat("at most ", kMaxImagePixels, " pixels in a scene"));
  }
  scene_.images.push_back({image->name.empty() ? image->uri : image->name, std::move(*pixels)});
  const Index index = static_cast<Index>(scene_.images.size() - 1);
  imported_.emplace(image_index, index);
  return index;
}

}  // namespace macula::scene::gltf
