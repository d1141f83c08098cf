// A glTF file as tinygltf understands it: JSON and buffers read, nothing of it believed yet. Images
// are left encoded; whoever needs one decodes it with limits (images.h).
#pragma once

#include <tiny_gltf.h>

#include <map>
#include <string>
#include <string_view>

#include "server/scene/files.h"
#include "shared/base/result.h"

namespace macula::scene::gltf {

struct Document {
  std::string path;  ///< as the user gave it
  SceneFolder folder;
  tinygltf::Model model;
  std::map<int, Bytes> inline_images;  ///< encoded bytes of the images given as data URIs

  /// "scene.gltf: accessor 12", for messages.
  std::string place(std::string_view kind, std::size_t index) const;
};

/// Reads .gltf (JSON) or .glb (told apart by their first bytes), the buffers they name, and checks
/// version and required extensions.
Result<Document> read_document(const std::string& path);

/// The pointer to table[index], or nullptr when the index is out of range.
template <class T>
const T* find(const std::vector<T>& table, int index) {
  return index >= 0 && static_cast<std::size_t>(index) < table.size()
             ? &table[static_cast<std::size_t>(index)]
             : nullptr;
}

}  // namespace macula::scene::gltf
