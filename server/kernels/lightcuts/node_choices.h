// Which light stands for every node of every point's cut in a tile: by a walk of its own, or taken
// from the low-resolution picture. What is done with it is the caller's.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "server/kernels/lightcuts/cut_light.h"
#include "server/lights/cut_sampler.h"

namespace macula::kernels::lightcuts {

/// Fewer nodes know less of what matters than a low pixel's rays; so many are the better strata.
inline constexpr std::uint32_t kLargeCut = 8;

/// The `round`-th node of a point's cut.
struct CutNode {
  std::uint32_t point = 0, round = 0;
};

inline lights::Receiver receiver_of(const ray::LitPoints& points, std::size_t i) {
  return {points.position[i], points.reflectors.shading[i]};
}

/// The low pixels around a cell, and how likely each is asked: by nearness, for surfaces alike.
/// Surfaces alone decide, never what was drawn there.
class LowNeighbours {
 public:
  LowNeighbours(const LowPicture& low, const image::Pixel& cell, const lights::Receiver& receiver);
  /// Not where all are too unlike.
  bool any() const;
  /// For u in [0, 1); with any().
  const LowSamples& choose(float u) const;

 private:
  void add(const LowPicture& low, const Vec2& place, const image::Pixel& pixel,
           const lights::Receiver& receiver);

  int count_ = 0;
  const LowSamples* pixel_[4] = {};
  float weight_[4] = {};
  float sum_ = 0.0F;
};

/// Calls sink(CutNode, LeafChoice) once for every node of every cut; a point's own in an order that
/// depends on it alone, all before those of later points but within one walk's batch.
template <class Sink>
class NodeChoices {
 public:
  NodeChoices(const SceneFrame& scene, const SurfaceTile& tile, const CutPlan& plan, CutWork& work,
              Sink& sink)
      : tree_(scene.placed_lights().tree()), tile_(tile), plan_(plan), work_(work), sink_(sink) {}

  void run() {
    for (std::size_t i = 0; i < tile_.points.count; ++i) {
      cut(i);
      if (descents_.size() >= kTogether) walk();
    }
    walk();
  }

 private:
  static constexpr std::size_t kTogether = 512;
  static constexpr std::uint32_t kTakeDimension =
      0xE000'0000U;  ///< of random numbers, four a round

  void cut(std::size_t i) {
    const image::Pixel cell = tile_.pixel(i);
    const lights::Receiver receiver = receiver_of(tile_.points, i);
    const auto point = static_cast<std::uint32_t>(i);
    const std::uint32_t nodes = plan_.nodes(cell.x, cell.y);
    // With a node for every light nothing need be left to chance.
    const bool by_node = nodes >= kLargeCut || nodes >= tree_.light_count();
    std::optional<LowNeighbours> low;
    if (plan_.low != nullptr && !(by_node && plan_.smoothed))
      low.emplace(*plan_.low, cell, receiver);
    if (low && !low->any()) low.reset();
    const std::uint32_t taken = low && !by_node ? take(point, nodes, *low) : 0;
    if (taken == nodes) return;
    lights::LightWalk(tree_, receiver).cut(nodes - taken, cut_);
    const double share = static_cast<double>(nodes - taken) / nodes;
    for (std::uint32_t r = 0; r < cut_.nodes.size(); ++r) {
      const CutNode node{point, taken + r};
      if (low && by_node && takes(node, *low, cut_.nodes[r])) continue;
      add_walk(node, receiver, cut_.nodes[r], share);
    }
  }
  float own_share(std::uint32_t point) const {
    const image::Pixel cell = tile_.pixel(point);
    return (*plan_.map)(cell.x, cell.y);
  }

  /// Of a point's `nodes` lights those that are drawn of all that low pixels drew, evenly over
  /// what these brought: how many. Each stands for an equal part of all light.
  std::uint32_t take(std::uint32_t point, std::uint32_t nodes, const LowNeighbours& low) {
    const sampling::SampleKey key = tile_.points.keys[point];
    const float walks = own_share(point) * static_cast<float>(nodes);
    const auto walked = static_cast<std::uint32_t>(walks + sampling::sample(key, kTakeDimension));
    if (walked >= nodes) return 0;
    const std::uint32_t taken = nodes - walked;
    for (std::uint32_t k = 0; k < taken; ++k) {
      const std::uint32_t dimension = kTakeDimension + 1U + 2U * k;
      const LowSamples& pixel = low.choose(sampling::sample(key, dimension));
      const auto u = static_cast<double>(sampling::sample(key, dimension + 1U));
      lights::LeafChoice choice = pixel.take(tree_, 1, (k + u) / taken);
      choice.probability *= nodes;
      sink_(CutNode{point, k}, choice);
    }
    work_.taken += taken;
    return taken;
  }
  /// Whether a node's light is one that a low pixel drew for it.
  bool takes(const CutNode& node, const LowNeighbours& low, lights::NodeId id) {
    const sampling::SampleKey key = tile_.points.keys[node.point];
    const std::uint32_t dimension = kTakeDimension + 4U * node.round;
    if (sampling::sample(key, dimension) < own_share(node.point)) return false;
    const auto u = static_cast<double>(sampling::sample(key, dimension + 2U));
    const lights::LeafChoice choice =
        low.choose(sampling::sample(key, dimension + 1U)).take(tree_, id, u);
    if (choice.leaf == 0 && choice.probability == 0.0) return false;
    ++work_.taken;
    sink_(node, choice);
    return true;
  }

  /// `share`: what the cut's light counts for in its point's.
  void add_walk(const CutNode& walker, const lights::Receiver& receiver, lights::NodeId node,
                double share) {
    descents_.push_back(
        {receiver, node,
         lights::leaf_number(tile_.points.keys[walker.point], walker.round, tile_.points.sample)});
    walkers_.push_back(walker), shares_.push_back(share);
  }
  void walk() {
    choices_.resize(descents_.size());
    lights::choose_each(tree_, lights::WeightRule::NearAndFar, descents_, choices_);
    for (std::size_t k = 0; k < walkers_.size(); ++k) {
      choices_[k].probability /= shares_[k];
      sink_(walkers_[k], choices_[k]);
    }
    work_.walked += walkers_.size();
    descents_.clear(), walkers_.clear(), shares_.clear();
  }

  const lights::LightTree& tree_;
  const SurfaceTile& tile_;
  const CutPlan& plan_;
  CutWork& work_;
  Sink& sink_;
  lights::LightCut cut_;
  std::vector<lights::Descent> descents_;
  std::vector<CutNode> walkers_;
  std::vector<double> shares_;  ///< that each walk's cut has in its point's light
  std::vector<lights::LeafChoice> choices_;
};

}  // namespace macula::kernels::lightcuts
