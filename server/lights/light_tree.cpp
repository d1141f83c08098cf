#include "server/lights/light_tree.h"

#include <algorithm>
#include <vector>

#include "server/lights/light_tree_simd.h"
#include "shared/base/check.h"

namespace macula::lights {
namespace {

constexpr std::size_t kNodes = NodeBlock::kNodes;

}  // namespace

void LightTree::resize(std::size_t lights) {
  MACULA_CHECK(lights <= (std::size_t{1} << 30), "a node's id has 32 bits");
  first_leaf_ = std::bit_ceil(static_cast<NodeId>(std::max<std::size_t>(lights, 1)));
  // Block 0 is made from its own nodes and those of block 1: both are always there.
  const std::size_t nodes = std::max<std::size_t>(2 * std::size_t{first_leaf_}, 2 * kNodes);
  blocks_.resize(nodes / kNodes);
  intensity_.resize(first_leaf_);
}

void LightTree::build(std::span<const LightBounds> lights) {
  resize(lights.size());
  std::vector<Vec4> places;
  brightest_ = 0.0;
  oriented_ = Oriented::No;
  Vec3 low = lights.empty() ? Vec3{0.0F} : lights.front().centre, high = low;
  for (const LightBounds& light : lights) {
    brightest_ = std::max(brightest_, light.intensity);
    if (!light.shines_everywhere()) oriented_ = Oriented::Yes;
    low = glm::min(low, light.centre), high = glm::max(high, light.centre);
    places.emplace_back(light.centre, 0.0F);
  }
  morton_.sort(places, cube_about(low, high), light_of_leaf_);
  grow_tree({lights, light_of_leaf_, brightest_, oriented_}, {blocks_, intensity_, first_leaf_});
  find_radius();
}

void LightTree::build(const PlacedLightTable& table) {
  resize(table.size());
  brightest_ = table.brightest;
  oriented_ = table.oriented;
  morton_.sort(table.places, cube_about(table.low, table.high), light_of_leaf_);
  grow_tree({table, light_of_leaf_}, {blocks_, intensity_, first_leaf_});
  find_radius();
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
  const auto share = static_cast<double>(block.intensity[lane]);
  bounds.intensity = (is_leaf(id) ? share : intensity_[id]) * brightest_;
  if (oriented_ == Oriented::No) return {bounds, false};
  bounds.axis = {block.axis_x[lane], block.axis_y[lane], block.axis_z[lane]};
  bounds.half_sine = block.half_sine[lane];
  bounds.cos_emission = block.cos_emission[lane];
  return {bounds, false};
}

}  // namespace macula::lights
