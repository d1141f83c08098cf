#include "tests/bench/scalar_walk.h"

#include <algorithm>
#include <cmath>

#include "server/sampling/frame.h"

namespace macula::bench {

using lights::NodeId;

struct ScalarTree::Eye {
  Vec3 position;
  Mat3 frame;
};

ScalarTree::ScalarTree(const lights::LightTree& tree)
    : nodes_(2 * std::size_t{tree.first_leaf()}),
      first_leaf_(tree.first_leaf()),
      oriented_(tree.oriented() == lights::Oriented::Yes) {
  const double total = tree.node(1).empty ? 1.0 : tree.node(1).bounds.intensity;
  for (NodeId id = 1; id < nodes_.size(); ++id) {
    const lights::NodeBounds node = tree.node(id);
    if (node.empty) continue;
    const lights::LightBounds& b = node.bounds;
    nodes_[id] = {b.centre,    b.half,         b.axis,
                  b.half_sine, b.cos_emission, static_cast<float>(b.intensity / total)};
  }
}

ScalarTree::Weight ScalarTree::weigh(const Eye& eye, const Node& node) const {
  const Vec3 c = node.centre - eye.position, h = node.half;
  const auto least = [&](const Vec3& axis) {
    return std::max(std::abs(glm::dot(axis, c)) - glm::dot(glm::abs(axis), h), 0.0F);
  };
  const Vec3& n = eye.frame[2];
  const float top = std::max(glm::dot(n, c) + glm::dot(glm::abs(n), h), 0.0F);
  const float t = least(eye.frame[0]), b = least(eye.frame[1]);
  float bound = top > 0.0F ? top / std::sqrt(top * top + t * t + b * b) : 0.0F;
  if (oriented_ && bound > 0.0F) {
    const float distance2 = glm::dot(c, c), radius2 = glm::dot(h, h);
    const float cos_u = std::sqrt(std::max(distance2 - radius2, 0.0F)), sin_u = std::sqrt(radius2);
    const float cos_theta = -glm::dot(node.axis, c);
    const float sin_theta = std::sqrt(std::max(distance2 - cos_theta * cos_theta, 0.0F));
    const float half2 = node.half_sine * node.half_sine;
    const float cos_o = 1.0F - 2.0F * half2;
    const float sin_o = 2.0F * node.half_sine * std::sqrt(std::max(1.0F - half2, 0.0F));
    const float cos_w = cos_o * cos_u - sin_o * sin_u, sin_w = sin_o * cos_u + cos_o * sin_u;
    const bool full = radius2 >= distance2 || cos_theta >= cos_w || (cos_w < 0.0F && sin_w <= 0.0F);
    if (!full) {
      const float past = cos_theta * cos_w + sin_theta * sin_w;
      bound *= past > node.cos_emission * distance2 ? std::min(past / distance2, 1.0F) : 0.0F;
    }
  }
  const Vec3 near = glm::max(glm::abs(c) - h, Vec3{0.0F}), far = glm::abs(c) + h;
  return {node.intensity * bound, glm::dot(near, near), glm::dot(far, far)};
}

lights::LeafChoice ScalarTree::choose(const lights::Receiver& receiver, float u) const {
  const Eye eye{receiver.position, sampling::frame_from_normal(receiver.normal)};
  double probability = 1.0;
  NodeId node = 1;
  while (node < first_leaf_) {
    const Weight a = weigh(eye, nodes_[2 * node]), b = weigh(eye, nodes_[2 * node + 1]);
    if (!(a.weight + b.weight > 0.0F)) return {};
    const auto share = [&](float a2, float b2) {
      const float mine = a.weight * b2, other = b.weight * a2;
      return mine + other > 0.0F ? mine / (mine + other) : a.weight / (a.weight + b.weight);
    };
    const float p = 0.5F * (share(a.near2, b.near2) + share(a.far2, b.far2));
    const bool left = u < p;
    probability *= static_cast<double>(left ? p : 1.0F - p);
    u = std::clamp(left ? u / p : (u - p) / (1.0F - p), 0.0F, 0x1.fffffep-1F);
    node = 2 * node + (left ? 0 : 1);
  }
  return {node, probability};
}

}  // namespace macula::bench
