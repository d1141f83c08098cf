#include "server/scene/gltf/import.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "server/scene/gltf/document.h"
#include "server/scene/gltf/materials.h"
#include "server/scene/gltf/meshes.h"
#include "server/scene/gltf/nodes.h"
#include "server/scene/warnings.h"

namespace macula::scene::gltf {
namespace {

/// Extensions that change nothing here, or whose loss is reported where it happens.
constexpr std::array<std::string_view, 5> kHandledExtensions{
    "KHR_materials_emissive_strength", "KHR_materials_specular", "KHR_texture_transform",
    "KHR_lights_punctual", "KHR_materials_transmission"};

void warn_about_the_file(const Document& document, Warnings& warnings) {
  for (const std::string& name : document.model.extensionsUsed) {
    if (std::find(kHandledExtensions.begin(), kHandledExtensions.end(), name) ==
        kHandledExtensions.end()) {
      warnings.add("the extension " + name + " is ignored");
    }
  }
}

}  // namespace

Result<Scene> import_file(const std::string& path) {
  const Result<Document> document = read_document(path);
  if (!document) return forward(document);
  Scene scene;
  scene.name = std::filesystem::path(path).stem().string();
  Warnings warnings;
  warn_about_the_file(*document, warnings);
  const auto materials = import_materials(*document, scene, warnings);
  if (!materials) return forward(materials);
  MeshImporter meshes(*document, *materials, scene, warnings);
  const auto motions = import_animations(*document, warnings);
  if (!motions) return forward(motions);
  if (const auto nodes = import_nodes(*document, *motions, meshes, scene, warnings); !nodes)
    return forward(nodes);
  if (scene.triangle_count() == 0) {
    return base::bad_input("the scene shows no triangles", path,
                           "it needs a node with a mesh of triangles");
  }
  scene.warnings = warnings.sentences();
  return scene;
}

}  // namespace macula::scene::gltf
