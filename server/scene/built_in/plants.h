// Plants: a tree's wood and its leaves are two meshes of one frame, root at the origin, meters.
#pragma once

#include <cstdint>
#include <string>

#include "server/scene/built_in/builder.h"
#include "server/scene/scene.h"

namespace macula::scene::built_in {

struct Tree {
  Mesh wood;
  Mesh leaves;  ///< bent cards for a foliage picture (foliage_material)
};
struct TreeShape {
  float height = 7.0F;      ///< m, of the crown's top, about
  float bare_trunk = 2.2F;  ///< m below the first branch
  int branches = 14;        ///< from the trunk
  int sprigs_per_branch = 26;
  float sprig_length = 0.55F;  ///< m
};
Tree tree(const TreeShape& shape, std::uint64_t seed);

/// A picture made by foliage() on cards whose v counts upwards from the stem; alpha tested.
Material foliage_material(std::string name, Index image);

}  // namespace macula::scene::built_in
