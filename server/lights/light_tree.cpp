#include "server/lights/light_tree.h"

#include <algorithm>

#include "server/lights/light_tree_simd.h"
#include "shared/base/check.h"

namespace macula::lights {
namespace {

constexpr std::size_t kNodes = NodeBlock::kNodes;

}  // namespace

void LightTree::build(std::span<const LightBounds> lights) {
  MACULA_CHECK(lights.size() <= (std::size_t{1} << 30), "a node's id has 32 bits");
  first_leaf_ = std::bit_ceil(static_cast<NodeId>(std::max<std::size_t>(lights.size(), 1)));
  // Block 0 is made from its own nodes and those of block 1: both are always there.
  const std::size_t nodes = std::max<std::size_t>(2 * std::size_t{first_leaf_}, 2 * kNodes);
  blocks_.resize(nodes / kNodes);
  intensity_.resize(nodes);
  look_at(lights);
  const auto order = morton_.sort(centres_);
  light_of_leaf_.assign(order.begin(), order.end());
  grow_tree({lights, light_of_leaf_, brightest_, oriented_}, {blocks_, intensity_, first_leaf_});
  find_radius();
}

void LightTree::look_at(std::span<const LightBounds> lights) {
  brightest_ = 0.0;
  bool oriented = false;
  centres_.resize(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    brightest_ = std::max(brightest_, lights[i].intensity);
    oriented |= !lights[i].shines_everywhere();
    centres_[i] = lights[i].centre;
  }
  oriented_ = oriented ? Oriented::Yes : Oriented::No;
}

void LightTree::find_radius() {
  const NodeBounds root = node(1);
  radius_m_ = root.empty ? 0.0F : glm::length(root.bounds.half);
}

NodeBounds LightTree::node(NodeId id) const {
  MACULA_DCHECK(id >= 1 && id < 2 * first_leaf_);
  const NodeBlock& block = blocks_[id / kNodes];
  const std::size_t lane = id % kNodes;
  if (!(block.intensity[lane] > 0.0F)) return {};
  LightBounds bounds;
  bounds.centre = {block.centre_x[lane], block.centre_y[lane], block.centre_z[lane]};
  bounds.half = {block.half_x[lane], block.half_y[lane], block.half_z[lane]};
  bounds.intensity = intensity_[id] * brightest_;
  if (oriented_ == Oriented::No) return {bounds, false};
  bounds.axis = {block.axis_x[lane], block.axis_y[lane], block.axis_z[lane]};
  bounds.half_sine = block.half_sine[lane];
  bounds.cos_emission = block.cos_emission[lane];
  return {bounds, false};
}

}  // namespace macula::lights
