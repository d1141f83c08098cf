// LightTree: a perfect binary tree over the lights of a scene that have a place, made anew in O(n)
// when they move, and asked at each receiver which lights matter there. World space, meters.
// Nodes are a 1-based heap: children 2v and 2v + 1, leaves [n, 2n), n a power of two; lights follow
// the Morton curve; leaves without a light come last. Every node bounds its lights: a box, a cone,
// the sum of intensities. Immutable between builds, then safe from any thread.
// Layout: 16 consecutive ids are one block, a structure of arrays. The nodes four levels below v
// are exactly block v, so one visit weighs 16 descendants in vectors and takes four levels.
// Sources: Lin and Yuksel, "Real-Time Stochastic Lightcuts", 2020 (perfect tree, weights); Conty
// Estevez and Kulla, "Importance Sampling of Many Lights", 2018 (cones).
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <span>

#include "server/lights/light_bounds.h"
#include "server/lights/morton.h"
#include "server/lights/placed_light_table.h"
#include "shared/base/big_vector.h"

namespace macula::lights {

using NodeId = std::uint32_t;  ///< 1-based heap id

/// 0 for the root.
constexpr int level_of(NodeId node) {
  return std::bit_width(node) - 1;
}
/// Edges between two nodes, by way of their lowest common ancestor.
constexpr int distance_between(NodeId a, NodeId b) {
  const int la = level_of(a), lb = level_of(b);
  const int shallow = la < lb ? la : lb;
  const NodeId apart = (a >> (la - shallow)) ^ (b >> (lb - shallow));
  return la + lb - 2 * (shallow - static_cast<int>(std::bit_width(apart)));
}

struct LeafRange {
  NodeId first, last;  ///< leaves, both included

  bool contains(NodeId leaf) const { return first <= leaf && leaf <= last; }
};

/// Sixteen nodes side by side.
struct alignas(64) NodeBlock {
  static constexpr std::size_t kNodes = 16;
  using Row = float[kNodes];
  Row centre_x, centre_y, centre_z, half_x, half_y, half_z;
  Row axis_x, axis_y, axis_z, half_sine, cos_emission;
  Row intensity;  ///< share of the brightest light's; 0: no light below this node
};

/// One node on its own, for looking at.
struct NodeBounds {
  LightBounds bounds;  ///< intensity in W/sr, summed in double
  bool empty = true;
};

class LightTree {
 public:
  LightTree() { build(std::span<const LightBounds>{}); }
  explicit LightTree(std::span<const LightBounds> lights) { build(lights); }

  /// Replaces the tree; keeps memory. At most 2^30 lights; intensities finite and > 0.
  void build(std::span<const LightBounds> lights);
  /// The same over a table's lights, each bounded by its row. At most 2^27: rows are gathered.
  void build(const PlacedLightTable& table);

  std::size_t light_count() const { return light_of_leaf_.size(); }
  NodeId first_leaf() const { return first_leaf_; }
  bool is_leaf(NodeId node) const { return node >= first_leaf_; }
  /// The leaves below a node.
  LeafRange leaves(NodeId node) const {
    const int down = level_of(first_leaf_) - level_of(node);
    const NodeId first = node << down;
    return {first, first + (NodeId{1} << down) - 1U};
  }
  /// Index of the light at a leaf, into the span it was built from; nullopt: none there.
  std::optional<std::uint32_t> light_at(NodeId leaf) const {
    const NodeId place = leaf - first_leaf_;
    if (place >= light_of_leaf_.size()) return std::nullopt;
    return light_of_leaf_[place];
  }
  NodeBounds node(NodeId id) const;

  // ---- for walks ----
  std::span<const NodeBlock> blocks() const { return blocks_; }
  std::span<const std::uint32_t> light_of_leaf() const { return light_of_leaf_; }
  Oriented oriented() const { return oriented_; }
  /// Half the diagonal of the box about all lights; 0 without any.
  float radius_m() const { return radius_m_; }

 private:
  void resize(std::size_t lights);
  void find_radius();

  MortonOrder morton_;
  base::BigVector<NodeBlock> blocks_;
  base::BigVector<double> intensity_;  ///< of inner nodes, shares of brightest_
  base::BigVector<std::uint32_t> light_of_leaf_;
  NodeId first_leaf_ = 1;
  double brightest_ = 0.0;  ///< largest intensity of a light, W/sr
  float radius_m_ = 0.0F;
  Oriented oriented_ = Oriented::No;
};

}  // namespace macula::lights
