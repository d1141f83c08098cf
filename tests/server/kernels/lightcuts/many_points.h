// Lights under a tree, and what each of them brings a point with nothing in between.
#pragma once

#include "tests/server/lights/tree_oracle.h"

namespace macula::kernels::lightcuts::test {

struct Lit {
  std::vector<lights::LightBounds> lights =
      lights::test::random_lights(120, lights::test::Kind::Mixed, 4);
  lights::LightTree tree{lights};

  double light(lights::NodeId leaf, const lights::Receiver& at) const {
    const auto index = tree.light_at(leaf);
    if (!index) return 0.0;
    const Vec3 towards = lights[*index].centre - at.position;
    return lights::test::reaching(lights[*index], at) /
           static_cast<double>(glm::dot(towards, towards));
  }
  double sum(lights::NodeId node, const lights::Receiver& at) const {
    double all = 0.0;
    const lights::LeafRange leaves = tree.leaves(node);
    for (lights::NodeId leaf = leaves.first; leaf <= leaves.last; ++leaf) all += light(leaf, at);
    return all;
  }
};

}  // namespace macula::kernels::lightcuts::test
