#include "server/lights/light_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/lights/light_tree_simd.h"
#include "shared/base/check.h"

namespace macula::lights {
namespace {

constexpr std::size_t kNodes = NodeBlock::kNodes;

/// However dim, a light that shines keeps a chance.
float share(double intensity) {
  return std::max(static_cast<float>(intensity), std::numeric_limits<float>::min());
}

void put(const LightBounds& light, double intensity, NodeBlock& block, std::size_t lane) {
  block.centre_x[lane] = light.centre.x;
  block.centre_y[lane] = light.centre.y;
  block.centre_z[lane] = light.centre.z;
  block.half_x[lane] = light.half.x;
  block.half_y[lane] = light.half.y;
  block.half_z[lane] = light.half.z;
  block.axis_x[lane] = light.axis.x;
  block.axis_y[lane] = light.axis.y;
  block.axis_z[lane] = light.axis.z;
  block.half_sine[lane] = light.half_sine;
  block.cos_emission[lane] = light.cos_emission;
  block.intensity[lane] = share(intensity);
}

}  // namespace

void LightTree::build(std::span<const LightBounds> lights) {
  MACULA_CHECK(lights.size() <= (std::size_t{1} << 30), "a node's id has 32 bits");
  first_leaf_ = std::bit_ceil(static_cast<NodeId>(std::max<std::size_t>(lights.size(), 1)));
  // Block 0 is made from its own nodes and those of block 1: both are always there.
  const std::size_t nodes = std::max<std::size_t>(2 * std::size_t{first_leaf_}, 2 * kNodes);
  blocks_.resize(nodes / kNodes);
  intensity_.resize(nodes);
  place_leaves(lights);
  sum_intensities();
  merge_levels(blocks_, first_leaf_, oriented_);
  find_radius();
}

void LightTree::place_leaves(std::span<const LightBounds> lights) {
  brightest_ = 0.0;
  oriented_ = Oriented::No;
  centres_.clear();
  for (const LightBounds& light : lights) {
    brightest_ = std::max(brightest_, light.intensity);
    if (!light.shines_everywhere()) oriented_ = Oriented::Yes;
    centres_.push_back(light.centre);
  }
  const auto order = morton_.sort(centres_);
  light_of_leaf_.assign(order.begin(), order.end());
  for (std::size_t block = first_leaf_ / kNodes; block < blocks_.size(); ++block) {
    std::ranges::fill(blocks_[block].intensity, 0.0F);
  }
  std::fill(intensity_.begin() + first_leaf_, intensity_.end(), 0.0);
  // Lights lie in memory in another order than along the curve: they are asked for in advance.
  constexpr std::size_t kAhead = 16;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k + kAhead < order.size()) __builtin_prefetch(&lights[order[k + kAhead]]);
    const LightBounds& light = lights[order[k]];
    const std::size_t leaf = first_leaf_ + k;
    intensity_[leaf] = light.intensity / brightest_;
    put(light, intensity_[leaf], blocks_[leaf / kNodes], leaf % kNodes);
  }
}

void LightTree::sum_intensities() {
  for (NodeId node = first_leaf_ - 1; node > 0; --node) {
    const double sum = intensity_[2 * node] + intensity_[2 * node + 1];
    intensity_[node] = sum;
    blocks_[node / kNodes].intensity[node % kNodes] = sum > 0.0 ? share(sum) : 0.0F;
  }
  blocks_[0].intensity[0] = 0.0F;  // no node
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
