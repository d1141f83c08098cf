// A light tree's weights once more, in double, one node at a time and with real angles: what the
// vectors are held to. Formulas: light_walk.h; bounds by the corners of the box where the
// vectors use linear forms.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "server/lights/light_walk.h"
#include "server/sampling/frame.h"
#include "shared/math/hash.h"

namespace macula::lights::test {

/// Independent uniform numbers, one after another.
class Random {
 public:
  explicit Random(std::uint64_t seed) : seed_(seed) {}
  double next() { return static_cast<double>(math::hash_combine(seed_, count_++) >> 11) * 0x1p-53; }
  Vec3 in_cube(double half) {
    const double x = next(), y = next();
    return Vec3(half * (2.0 * DVec3(x, y, next()) - 1.0));
  }
  Vec3 direction() {
    const double z = 2.0 * next() - 1.0, phi = 2.0 * std::numbers::pi * next();
    const double r = std::sqrt(1.0 - z * z);
    return Vec3(DVec3(r * std::cos(phi), r * std::sin(phi), z));
  }

 private:
  std::uint64_t seed_, count_ = 0;
};

inline LightBounds point_light(const Vec3& position, double intensity = 1.0) {
  LightBounds light;
  light.centre = position;
  light.intensity = intensity;
  return light;
}
/// A small one-sided patch: all of its light within 90 degrees of `axis`.
inline LightBounds patch_light(const Vec3& position, const Vec3& axis, double intensity = 1.0) {
  LightBounds light = point_light(position, intensity);
  light.half = Vec3{0.01F};
  light.axis = axis;
  light.half_sine = 0.0F;
  return light;
}

enum class Kind { Points, Patches, Mixed };
inline std::vector<LightBounds> random_lights(std::size_t count, Kind kind, std::uint64_t seed) {
  Random random(seed);
  std::vector<LightBounds> lights;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 place = random.in_cube(1.0);
    const double intensity = std::exp(4.0 * random.next() - 2.0);
    const bool patch = kind == Kind::Patches || (kind == Kind::Mixed && i % 3 == 0);
    lights.push_back(patch ? patch_light(place, random.direction(), intensity)
                           : point_light(place, intensity));
  }
  return lights;
}

inline double angle_between(const DVec3& a, const DVec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}
/// Half-angle of the cone of directions with full intensity.
inline double cone_of(const LightBounds& light) {
  return 2.0 * std::asin(std::min(1.0, static_cast<double>(light.half_sine)));
}

/// What the light sends to `receiver` at most from any one place of its box, over 1 / distance^2.
/// For a light that is a point this is exact.
inline double reaching(const LightBounds& light, const Receiver& receiver) {
  const DVec3 towards = DVec3(light.centre) - DVec3(receiver.position);
  const double distance = glm::length(towards);
  if (!(distance > 0.0)) return 0.0;
  const double cosine = glm::dot(DVec3(receiver.normal), towards) / distance;
  double emitted = 1.0;
  if (!light.shines_everywhere()) {
    const double past = angle_between(DVec3(light.axis), -towards) - cone_of(light);
    const double end = std::acos(std::clamp<double>(light.cos_emission, -1.0, 1.0));
    emitted = past <= 0.0 ? 1.0 : past < end ? std::max(std::cos(past), 0.0) : 0.0;
  }
  return light.intensity * std::max(cosine, 0.0) * emitted;
}

struct View {
  double weight, near2, far2;
};

/// What the vectors add to a bound of the lights' cosines, against rounding.
inline constexpr double kSlack = 1e-3;

/// Of a node's bounds, as light_walk.h has it.
inline View view_of(const LightBounds& node, const Receiver& receiver) {
  const DVec3 c = DVec3(node.centre) - DVec3(receiver.position), h(node.half);
  const Mat3 frame = sampling::frame_from_normal(receiver.normal);
  const auto least = [&](const Vec3& axis) {
    const double middle = glm::dot(DVec3(axis), c), reach = glm::dot(glm::abs(DVec3(axis)), h);
    return std::max(std::abs(middle) - reach, 0.0);
  };
  const double top = glm::dot(DVec3(frame[2]), c) + glm::dot(glm::abs(DVec3(frame[2])), h);
  const double cosine = top > 0.0 ? top / std::hypot(top, least(frame[0]), least(frame[1])) : 0.0;
  double emitted = 1.0;
  const double distance = glm::length(c), radius = glm::length(h);
  if (!node.shines_everywhere() && distance > radius) {
    const double past =
        angle_between(DVec3(node.axis), -c) - cone_of(node) - std::asin(radius / distance);
    const double end = std::acos(std::clamp<double>(node.cos_emission, -1.0, 1.0));
    emitted = past <= 0.0 ? 1.0 : past < end ? std::min(std::cos(past) + kSlack, 1.0) : 0.0;
  }
  const DVec3 near = glm::max(glm::abs(c) - h, DVec3{0.0}), far = glm::abs(c) + h;
  return {node.intensity * cosine * emitted, glm::dot(near, near), glm::dot(far, far)};
}

/// Chances of the nodes `levels` below, by the average rule; all 0 where none can be reached.
inline std::vector<double> chances(const std::vector<View>& views) {
  const auto shares = [&](auto distance2) {
    double least = INFINITY, total = 0.0;
    for (const View& view : views) {
      if (view.weight > 0.0) least = std::min(least, distance2(view));
    }
    std::vector<double> terms;
    for (const View& view : views) {
      const double relative = least > 0.0 ? least / distance2(view) : distance2(view) <= 0.0;
      terms.push_back(view.weight > 0.0 ? view.weight * relative : 0.0);
      total += terms.back();
    }
    for (double& term : terms) term = total > 0.0 ? term / total : 0.0;
    return terms;
  };
  const auto near = shares([](const View& view) { return view.near2; });
  const auto far = shares([](const View& view) { return view.far2; });
  std::vector<double> p(views.size());
  for (std::size_t i = 0; i < p.size(); ++i) p[i] = 0.5 * (near[i] + far[i]);
  return p;
}

/// P(leaf | node) with visits of at most `levels` levels: 4 is LightWalk's own way, 1 is Lin and
/// Yuksel's two children at a time.
inline double probability(const LightTree& tree, const Receiver& receiver, NodeId node, NodeId leaf,
                          int levels = 4) {
  double p = 1.0;
  while (node != leaf && p > 0.0) {
    const int left = level_of(leaf) - level_of(node);
    const int down = left % levels == 0 ? levels : left % levels;
    std::vector<View> views;
    for (NodeId k = 0; k < NodeId{1} << down; ++k) {
      const NodeBounds below = tree.node((node << down) + k);
      views.push_back(below.empty ? View{0.0, 0.0, 0.0} : view_of(below.bounds, receiver));
    }
    const NodeId next = leaf >> (left - down);
    p *= chances(views)[next - (node << down)];
    node = next;
  }
  return p;
}

}  // namespace macula::lights::test
