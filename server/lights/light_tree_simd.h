// The inner levels of a light tree, in vectors. Internal to the room.
#pragma once

#include <span>

#include "server/lights/light_tree.h"

namespace macula::lights {

/// Boxes and cones of nodes [1, first_leaf) from their children's; intensities are read only. The
/// box of a union is the union of the boxes, up to a few units in the last place wider.
void merge_levels(std::span<NodeBlock> blocks, NodeId first_leaf, Oriented oriented);

}  // namespace macula::lights
