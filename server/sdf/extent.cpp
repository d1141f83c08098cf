// Where the nodes of a field can be: what repetition needs to know of its cells.
#include <algorithm>
#include <cmath>

#include "server/sdf/placement.h"
#include "server/sdf/program.h"

namespace macula::sdf {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Extent around(const DVec3& half) {
  return {-half, half};
}
Extent everywhere() {
  return around(DVec3{kInfinity});
}
Extent joined(const Extent& a, const Extent& b) {
  return {glm::min(a.low, b.low), glm::max(a.high, b.high)};
}
Extent grown(const Extent& e, double by) {
  return {e.low - by, e.high + by};
}

class Measure {
 public:
  Measure(const Field& field, double time_s) : field_(field), time_s_(time_s) {}

  Extent placed(std::uint32_t index) const {
    const Node& node = field_.nodes[index];
    const Placement placement = placement_of(field_, node, time_s_);
    const Extent own = of(node);
    if (!std::isfinite(own.low.x + own.low.y + own.low.z + own.high.x + own.high.y + own.high.z))
      return placed_infinite(own, placement);
    const DVec3 centre = 0.5 * (own.low + own.high), half = 0.5 * (own.high - own.low);
    DVec3 reach{0.0};
    for (int axis = 0; axis < 3; ++axis) {
      reach += glm::abs(placement.rotation[axis]) * half[axis];
    }
    const DVec3 at = placement.at + placement.scale * (placement.rotation * centre);
    return {at - placement.scale * reach, at + placement.scale * reach};
  }

 private:
  static Extent placed_infinite(const Extent& own, const Placement& placement) {
    if (placement.turned) return everywhere();
    return {placement.at + placement.scale * own.low, placement.at + placement.scale * own.high};
  }
  DVec3 value(const Node& node, std::size_t i) const {
    return field_.at(node.parameters[i], time_s_);
  }
  Extent children(const Node& node) const {
    Extent all{DVec3{kInfinity}, DVec3{-kInfinity}};
    for (const std::uint32_t child : node.children) all = joined(all, placed(child));
    return all;
  }
  Extent of(const Node& node) const {
    switch (node.kind) {
      case Kind::Sphere:
      case Kind::Octahedron:
        return around(DVec3{value(node, 0).x});
      case Kind::Box:
      case Kind::Ellipsoid:
        return around(value(node, 0));
      case Kind::Torus:
        return torus(value(node, 0).x, value(node, 1).x);
      case Kind::Cylinder:
        return upright(value(node, 0).x, value(node, 1).x);
      case Kind::HexPrism:
        return upright(value(node, 0).x * 2.0 / std::sqrt(3.0), value(node, 1).x);
      case Kind::Cone:
        return upright(std::max(value(node, 0).x, value(node, 1).x), value(node, 2).x);
      case Kind::Capsule:
        return capsule(node);
      case Kind::Plane:
        return everywhere();
      case Kind::Union:
        return grown(children(node), 0.25 * value(node, 0).x);
      case Kind::Intersection:
        return intersection(node);
      case Kind::Difference:
        return placed(node.children.front());
      case Kind::Repeat:
        return repeated(node);
      case Kind::Mirror:
        return mirrored(node);
      case Kind::Twist:
        return turned(node, 1);
      case Kind::Bend:
        return turned(node, 2);
      case Kind::Shell:
        return grown(children(node), value(node, 0).x);
      case Kind::Round:
        return grown(children(node), value(node, 0).x);
      case Kind::Waves:
        return grown(children(node), value(node, 0).x);
      case Kind::Noise:
        return grown(children(node), 2.0 * value(node, 0).x);
    }
    return everywhere();
  }
  static Extent torus(double radius, double tube) {
    return around({radius + tube, tube, radius + tube});
  }
  static Extent upright(double radius, double half_height) {
    return around({radius, half_height, radius});
  }
  Extent capsule(const Node& node) const {
    const DVec3 from = value(node, 0), to = value(node, 1);
    return grown({glm::min(from, to), glm::max(from, to)}, value(node, 2).x);
  }
  Extent intersection(const Node& node) const {
    Extent all = everywhere();
    for (const std::uint32_t child : node.children) {
      const Extent each = placed(child);
      all = {glm::max(all.low, each.low), glm::min(all.high, each.high)};
    }
    return {glm::min(all.low, all.high), glm::max(all.low, all.high)};
  }
  Extent repeated(const Node& node) const {
    Extent all = children(node);
    const DVec3 period = value(node, 0);
    const bool alternates = value(node, 3).x > 0.5;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(period[axis] > 0.0)) continue;
      const double reach = std::max(std::abs(all.low[axis]), std::abs(all.high[axis]));
      if (alternates) all.low[axis] = -reach, all.high[axis] = reach;
      all.low[axis] += period[axis] * value(node, 1)[axis];
      all.high[axis] += period[axis] * value(node, 2)[axis];
    }
    return all;
  }
  Extent mirrored(const Node& node) const {
    Extent all = children(node);
    for (int axis = 0; axis < 3; ++axis) {
      if (value(node, 0)[axis] > 0.5) all.low[axis] = -std::abs(all.high[axis]);
    }
    return {glm::min(all.low, all.high), glm::max(all.low, all.high)};
  }
  /// Turning about `axis` keeps the distance from it.
  Extent turned(const Node& node, int axis) const {
    const Extent all = children(node);
    const double radius = value(node, 1).x;
    DVec3 half{radius};
    half[axis] = std::max(std::abs(all.low[axis]), std::abs(all.high[axis]));
    return around(half);
  }

  const Field& field_;
  double time_s_;
};

}  // namespace

Extent extent_of(const Field& field, std::uint32_t node, double time_s) {
  return Measure(field, time_s).placed(node);
}

}  // namespace macula::sdf
