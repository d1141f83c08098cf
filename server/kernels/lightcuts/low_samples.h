// LowSamples: the lights that one pixel of the low-resolution picture drew, one of every node of
// its cut, kept for the pixels around it: where such a pixel's cut has a node, a light of it can be
// taken from here instead of by a walk down the tree. Unbiased (the paper's Algorithm 2 with the
// right probabilities; ALGORITHMS: README.md). Walks of all samples are Defensive, and dark nodes
// are in, so that a light which the low pixel cannot see still has its chance.
//   A, the node holds nodes v_1 .. v_k of the low cut: i is drawn in proportion to a share s_i > 0,
//      and l_i has probability (s_i / sum s) P(l_i | v_i). The shares may depend on what the
//      samples brought where they were drawn: for any drawn samples the mean over i is
//      sum_i f(l_i) / P(l_i | v_i), and over the samples the node's sum.
//   B, the node lies below a node v_1 of the low cut: if l_1 happens to lie in it, its probability
//      is P(l_1 | v_1) / P(node | v_1); if not, a walk has to be made. Given either, the mean is
//      the node's sum.
#pragma once

#include <span>
#include <vector>

#include "server/lights/light_walk.h"
#include "server/scheduling/parcel.h"

namespace macula::kernels::lightcuts {

struct LowSample {
  lights::NodeId node = 0, leaf = 0;  ///< of the low cut; drawn, below it; leaf 0: none
  double probability = 0.0;           ///< P(leaf | node) at the low pixel
  float open = 0.0F;     ///< what it would bring the low pixel with nothing in between, luminance
  float brought = 0.0F;  ///< what it brought
};

class LowSamples {
 public:
  /// Of any order; no node below another. `receiver` is the low pixel's point.
  LowSamples(const lights::Receiver& receiver, std::vector<LowSample> samples);

  void carry(scheduling::Parcel& parcel) {
    parcel.value(receiver_), parcel.vector(samples_);
    parcel.vector(first_), parcel.vector(shares_);
  }
  const lights::Receiver& receiver() const { return receiver_; }
  std::span<const LowSample> samples() const { return samples_; }
  /// A leaf of `node` for u in [0, 1), with its probability given the node (of draws of samples and
  /// u together); leaf 0 with probability 1: the sample has no light to offer and counts as 0;
  /// leaf 0 with probability 0: walk.
  lights::LeafChoice take(const lights::LightTree& tree, lights::NodeId node, double u) const;

 private:
  lights::LeafChoice take_of_many(std::size_t first, std::size_t last, double u) const;
  lights::LeafChoice take_below(const lights::LightTree& tree, const LowSample& sample,
                                lights::NodeId node) const;

  lights::Receiver receiver_;
  std::vector<LowSample> samples_;     ///< by leaves
  std::vector<lights::NodeId> first_;  ///< leaf of each, at the last level
  std::vector<double> shares_;         ///< sums of the shares before each, and of all
};

}  // namespace macula::kernels::lightcuts
