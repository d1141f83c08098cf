// CutSampler: for up to a batch of receivers, each one's own cut of the light tree, and one light
// of every node of it. What a receiver draws is a function of it and its key alone. Holds a
// reference; one thread at a time; large, make one a batch. World space, meters.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "server/lights/light_walk.h"
#include "server/lights/placed_lights.h"
#include "server/sampling/batch.h"
#include "server/sampling/sample.h"

namespace macula::lights {

/// Which leaf a walk from the `round`-th node of a cut ends at, in [0, 1) with 53 bits; stratified
/// over `sample`.
double leaf_number(sampling::SampleKey key, std::uint32_t round, std::uint32_t sample);

class CutSampler {
 public:
  /// `most_nodes` >= 1: of one receiver's cut.
  CutSampler(const LightTree& tree, std::size_t most_nodes,
             WeightRule rule = WeightRule::NearAndFar)
      : tree_(tree), most_nodes_(most_nodes), rule_(rule) {}

  /// Makes the cuts of receivers at `points` with unit `normals`, of at most `most_nodes` each, or
  /// of most[i] where there are any: >= 1 and no more than `most_nodes`.
  void cut(const sampling::Vec3Batch& points, const sampling::Vec3Batch& normals, std::size_t count,
           std::span<const std::uint16_t> most = {});
  /// Nodes of the largest cut.
  std::size_t rounds() const { return rounds_; }
  /// One light of the `round`-th node of every cut that has it. Draws of one key are stratified
  /// over `sample`.
  void draw(std::size_t round, std::span<const sampling::SampleKey> keys, std::uint32_t sample,
            LightDraws& out) const;

 private:
  const LightTree& tree_;
  std::size_t most_nodes_;
  WeightRule rule_;
  std::size_t count_ = 0, rounds_ = 0;
  LightCut cut_;
  std::array<Receiver, sampling::kBatch> receivers_;
  std::array<std::uint32_t, sampling::kBatch + 1> first_;  ///< of each receiver's stretch of nodes_
  std::vector<NodeId> nodes_;
};

}  // namespace macula::lights
