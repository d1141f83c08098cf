// Lin and Yuksel's walk as a processor without vectors does it: two children a step, both in one
// stretch of memory. The measure of LightWalk's speed; its choices differ, its rule does not.
#pragma once

#include <vector>

#include "server/lights/light_walk.h"

namespace macula::bench {

class ScalarTree {
 public:
  explicit ScalarTree(const lights::LightTree& tree);
  /// A leaf below the root for u in [0, 1), as LightWalk::choose(1, u).
  lights::LeafChoice choose(const lights::Receiver& receiver, float u) const;

 private:
  struct Node {
    Vec3 centre{0.0F}, half{0.0F}, axis{0.0F};
    float half_sine = 1.0F, cos_emission = 0.0F, intensity = 0.0F;
  };
  struct Weight {
    float weight, near2, far2;
  };
  struct Eye;
  Weight weigh(const Eye& eye, const Node& node) const;

  std::vector<Node> nodes_;
  lights::NodeId first_leaf_;
  bool oriented_;
};

}  // namespace macula::bench
