// glTF materials -> scene materials: metallic-roughness with KHR_materials_emissive_strength,
// KHR_materials_specular and KHR_texture_transform. What is ignored becomes a warning.
#pragma once

#include <vector>

#include "server/scene/gltf/document.h"
#include "server/scene/scene.h"
#include "server/scene/warnings.h"

namespace macula::scene::gltf {

struct ImportedMaterials {
  std::vector<int> texcoord_sets;  ///< per material: the TEXCOORD_n its textures use
  Index fallback = 0;              ///< the glTF default material, for primitives without one
};

/// Fills scene.materials (same indices as in the file, the default one last) and scene.images.
Result<ImportedMaterials> import_materials(const Document& document, Scene& scene,
                                           Warnings& warnings);

}  // namespace macula::scene::gltf
