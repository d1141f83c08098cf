// LightWalk: a light tree seen from one receiver: which nodes stand for all lights there (the cut),
// and which light to ask for each of them (a walk down to a leaf), with its exact probability.
// World space, meters. Holds references; cheap to make; one thread at a time.
// A node's weight at receiver x is A = intensity x bound of the cosine at x x bound of the cosine
// at the light. From node v a walk goes to one of the nodes four levels below it (fewer at first
// where the leaves' distance is no multiple of four) with probability
//   (A / dmin^2 / sum + A / dmax^2 / sum) / 2,
// distances being those to the nodes' boxes; where x lies inside boxes, those share the first term
// by A alone. That is Lin and Yuksel's average rule ("Real-Time Stochastic Lightcuts",
// 2020, section 4), for sixteen children instead of two. A node of weight 0 has no light that can
// reach x, so nothing is lost by never going there.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/lights/light_tree.h"

namespace macula::lights {

/// Where light is received: a point and the normal its cosines are taken with, unit.
struct Receiver {
  Vec3 position{0.0F}, normal{0.0F, 0.0F, 1.0F};
};

/// NearAndFar: the rule above. NearOrIntensity: Yuksel 2019, A / dmin^2, but A alone wherever x is
/// nearer to one of the children than that child's diagonal. Defensive: the rule above with a share
/// of kDefensiveShare by intensity alone, which every light has a chance by, seen from x or not: a
/// light drawn here may be asked elsewhere.
enum class WeightRule { NearAndFar, NearOrIntensity, Defensive };
inline constexpr float kDefensiveShare = 0.05F;

struct LeafChoice {
  NodeId leaf = 0;           ///< 0: no light below the node reaches the receiver
  double probability = 0.0;  ///< of this leaf, given the node the walk began at
};

/// What can be told about a node's lights from the receiver.
struct NodeView {
  float weight = 0.0F;                    ///< A, in shares of the brightest light's intensity
  float near2_m2 = 0.0F, far2_m2 = 0.0F;  ///< squared distances to its box
};

/// Nodes that together hold every light which can reach a receiver, each light once. Keeps memory.
struct LightCut {
  std::vector<NodeId> nodes;
  std::vector<NodeId> dark;  ///< nodes with lights none of which can reach the receiver

  // ---- while it is made ----
  struct Candidate {  ///< may still be split
    float bound;
    NodeId node;
  };
  static constexpr NodeId kNoBlock = ~NodeId{0};
  struct alignas(64) Seen {  ///< a block whose bounds are known
    float bound[NodeBlock::kNodes];
    NodeId block = kNoBlock;
  };
  std::vector<Candidate> candidates;
  std::array<Seen, 32> seen;
};

class LightWalk {
 public:
  LightWalk(const LightTree& tree, const Receiver& receiver,
            WeightRule rule = WeightRule::NearAndFar);

  /// The cut's nodes: begins with the root and splits the node with the largest bound
  ///   A / max(dmin^2, (least_distance x radius of all lights)^2)
  /// until there are `most_nodes` or only leaves; nodes whose lights cannot reach the receiver are
  /// dropped, into `dark`. Ties go to the smaller id. The bound is all that is asked, no sample: an
  /// estimate over the nodes stays unbiased.
  void cut(std::size_t most_nodes, LightCut& cut) const;
  /// A leaf below `node` for u in [0, 1).
  LeafChoice choose(NodeId node, double u) const;
  /// How likely choose(node) is to end at or below `inner`, which is a node below it or itself.
  double probability(NodeId node, NodeId inner) const;
  NodeView view(NodeId node) const;

 private:
  const LightTree& tree_;
  Receiver receiver_;
  WeightRule rule_;
};

/// A walk to make: LightWalk(tree, receiver, rule).choose(node, u).
struct Descent {
  Receiver receiver;
  NodeId node = 1;
  double u = 0.0;  ///< in [0, 1)
};
/// Makes every walk; choices[i] is what descents[i] chooses by itself. Several are on their way at
/// a time, so that while one waits for its next block the others are weighed.
void choose_each(const LightTree& tree, WeightRule rule, std::span<const Descent> descents,
                 std::span<LeafChoice> choices);

/// As a share of the lights' radius: nearer, distances no longer make a node more urgent to split.
inline constexpr float kLeastCutDistance = 0.001F;

}  // namespace macula::lights
