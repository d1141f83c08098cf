// The node tree -> joints (the nodes that move), instances, cameras and lights, in the file's own
// units. Iterative: a chain of any length costs no stack; every node may be reached once only, so
// cycles end in an error.
#pragma once

#include "server/scene/gltf/animations.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/meshes.h"
#include "server/scene/scene.h"
#include "server/scene/warnings.h"

namespace macula::scene::gltf {

inline constexpr std::size_t kMaxNodeDepth = 1024;

Result<void> import_nodes(const Document& document, const std::map<int, NodeMotion>& motions,
                          MeshImporter& meshes, Scene& scene, Warnings& warnings);

}  // namespace macula::scene::gltf
