// The nodes of a light tree, in vectors. Internal to the room.
#pragma once

#include <span>

#include "server/lights/light_tree.h"

namespace macula::lights {

/// What leaves are made from; order[k]: the light of the k-th leaf.
struct BoundLights {
  std::span<const LightBounds> lights;
  std::span<const std::uint32_t> order;
  double brightest;   ///< largest intensity, W/sr
  Oriented oriented;  ///< No: rows about cones are neither read nor written
};
struct TableLights {
  const PlacedLightTable& table;
  std::span<const std::uint32_t> order;
};
struct TreeNodes {
  std::span<NodeBlock> blocks;  ///< of nodes [0, 2 first_leaf), at least two
  std::span<double> intensity;  ///< of inner nodes, shares of the brightest light's
  NodeId first_leaf;
};

/// Writes every node, each block of parents right after its children while they are near. The box
/// of a union is the union of the boxes, up to a few units in the last place wider.
void grow_tree(const BoundLights& leaves, const TreeNodes& nodes);
void grow_tree(const TableLights& leaves, const TreeNodes& nodes);

}  // namespace macula::lights
