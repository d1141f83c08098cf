// glTF meshes -> scene meshes, one a primitive, triangles only. Vertices are finite and indices in
// range afterwards; vertices that a primitive does not use are left behind.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "server/scene/gltf/document.h"
#include "server/scene/gltf/materials.h"
#include "server/scene/scene.h"
#include "server/scene/warnings.h"

namespace macula::scene::gltf {

inline constexpr std::uint64_t kMaxTriangles = std::uint64_t{1} << 26;  ///< unique ones, in a scene

class MeshImporter {
 public:
  MeshImporter(const Document& document, const ImportedMaterials& materials, Scene& scene,
               Warnings& warnings)
      : document_(document), materials_(materials), scene_(scene), warnings_(warnings) {}

  /// The scene meshes of a glTF mesh, one for each primitive of triangles; imported at first use.
  Result<std::vector<Index>> require(int mesh);

 private:
  Result<Mesh> import_primitive(const tinygltf::Primitive& primitive, const std::string& place);
  Result<Index> material_of(const tinygltf::Primitive& primitive, const std::string& place) const;

  const Document& document_;
  const ImportedMaterials& materials_;
  Scene& scene_;
  Warnings& warnings_;
  std::map<int, std::vector<Index>> imported_;
  std::uint64_t triangles_ = 0;
};

}  // namespace macula::scene::gltf
