// glTF animations -> the motion of nodes: translation, rotation and scale with STEP, LINEAR and
// CUBICSPLINE. Each node follows the first animation that names it; animations of different nodes
// run together, and each begins again when its last key has passed (glTF leaves both to the
// player). Morph weights are ignored with a warning. Source: glTF 2.0, section 3.11.
#pragma once

#include <map>

#include "server/scene/gltf/document.h"
#include "server/scene/motion.h"
#include "server/scene/warnings.h"

namespace macula::scene::gltf {

inline constexpr std::size_t kMaxKeyValues = std::size_t{1} << 22;  ///< over a scene

struct NodeMotion {
  Track<DVec3> translations, scales;
  Track<DQuat> rotations;
  Nanoseconds period{0};  ///< the whole animation's length
};

/// By index of the node. Times rise, values are finite, rotations have a direction.
Result<std::map<int, NodeMotion>> import_animations(const Document& document, Warnings& warnings);

}  // namespace macula::scene::gltf
