#include "server/scene/gltf/images.h"

#include <span>

#include "server/scene/gltf/accessor.h"
#include "shared/base/text.h"

namespace macula::scene::gltf {
namespace {

using Encoded = std::span<const std::byte>;

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
  auto pixels = decoder_.decode(encoded, place);
  if (!pixels) return forward(pixels);
  scene_.images.push_back({image->name.empty() ? image->uri : image->name, std::move(*pixels)});
  const Index index = static_cast<Index>(scene_.images.size() - 1);
  imported_.emplace(image_index, index);
  return index;
}

}  // namespace macula::scene::gltf
