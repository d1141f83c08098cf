// Which light stands for every node of every point's cut in a tile: by a walk of its own, or taken
// from the low-resolution picture. What is done with it is the caller's.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "server/kernels/lightcuts/cut_light.h"
#include "server/lights/cut_sampler.h"

namespace macula::kernels::lightcuts {

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
  /// For u in [0, 1); none: too unlike.
  const LowSamples* choose(float u) const;

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
    lights::LightWalk(tree_, receiver).cut(plan_.nodes(cell.x, cell.y), cut_);
    if (plan_.low == nullptr) {
      for (std::uint32_t r = 0; r < cut_.nodes.size(); ++r) add_walk({point, r}, receiver);
      return;
    }
    const LowNeighbours neighbours(*plan_.low, cell, receiver);
    const float own = (*plan_.map)(cell.x, cell.y);
    for (std::uint32_t r = 0; r < cut_.nodes.size(); ++r) {
      if (!take({point, r}, neighbours, own)) add_walk({point, r}, receiver);
    }
  }

  bool take(const CutNode& node, const LowNeighbours& neighbours, float own) {
    const sampling::SampleKey key = tile_.points.keys[node.point];
    const std::uint32_t dimension = kTakeDimension + 4U * node.round;
    if (sampling::sample(key, dimension) < own) return false;
    const LowSamples* low = neighbours.choose(sampling::sample(key, dimension + 1U));
    if (low == nullptr) return false;
    const auto u = static_cast<double>(sampling::sample(key, dimension + 2U));
    const lights::LeafChoice choice = low->take(tree_, cut_.nodes[node.round], u);
    if (choice.leaf == 0 && choice.probability == 0.0) return false;
    ++work_.taken;
    sink_(node, choice);
    return true;
  }

  void add_walk(const CutNode& node, const lights::Receiver& receiver) {
    descents_.push_back(
        {receiver, cut_.nodes[node.round],
         lights::leaf_number(tile_.points.keys[node.point], node.round, tile_.points.sample)});
    walkers_.push_back(node);
  }
  void walk() {
    choices_.resize(descents_.size());
    lights::choose_each(tree_, lights::WeightRule::NearAndFar, descents_, choices_);
    for (std::size_t k = 0; k < walkers_.size(); ++k) sink_(walkers_[k], choices_[k]);
    work_.walked += walkers_.size();
    descents_.clear(), walkers_.clear();
  }

  const lights::LightTree& tree_;
  const SurfaceTile& tile_;
  const CutPlan& plan_;
  CutWork& work_;
  Sink& sink_;
  lights::LightCut cut_;
  std::vector<lights::Descent> descents_;
  std::vector<CutNode> walkers_;
  std::vector<lights::LeafChoice> choices_;
};

}  // namespace macula::kernels::lightcuts
