// Decodes the images that materials use, each once, PNG and JPEG, within limits on side and sum.
#pragma once

#include <map>

#include "server/scene/decode_image.h"
#include "server/scene/gltf/document.h"
#include "server/scene/scene.h"

namespace macula::scene::gltf {

class ImageImporter {
 public:
  /// Appends to scene.images. Both must outlive the importer.
  ImageImporter(const Document& document, Scene& scene) : document_(document), scene_(scene) {}

  /// The scene's index of a glTF image.
  Result<Index> require(int image);

 private:
  const Document& document_;
  Scene& scene_;
  std::map<int, Index> imported_;
  ImageDecoder decoder_;
};

}  // namespace macula::scene::gltf
