#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "server/sdf/placement.h"
#include "server/sdf/program.h"
#include "shared/base/check.h"

namespace macula::sdf {
namespace {

/// Beyond this index a repetition counts as endless; floats count exactly up to it.
constexpr double kLastCell = 1 << 22;
/// Content of a repeated cell is cut here, as a share of the period, so that neighbours stay apart.
constexpr double kCellShare = 0.499;
/// Largest slope of one octave of value noise with unit cells, 2 sqrt(3): by Parseval the sum over
/// axes of a (1 - a) (dV/da)^2 is at most 1 for faded coordinates a, and the fade's slope squared
/// is at most 12 a (1 - a).
constexpr double kNoiseSlope = 3.4642;

constexpr double kPi = 3.14159265358979323846;

/// Coordinates of a node within a point register: register = offset + scale * own.
struct Frame {
  std::uint32_t point = 0;
  DVec3 offset{0.0};
  double scale = 1.0;
};

class Compiler {
 public:
  Compiler(const Field& field, double time_s) : field_(field), time_s_(time_s) {}

  Program run(const DVec3& eye) {
    MACULA_CHECK(!field_.nodes.empty(), "a field has a root");
    program_.eye = eye;
    program_.far_m = static_cast<float>(field_.far_m);
    program_.code.emplace_back();
    node(static_cast<std::uint32_t>(field_.nodes.size() - 1), {0, -eye, 1.0}, 1.0, 0);
    return std::move(program_);
  }

 private:
  // `lipschitz` is the bound of the node's value as a function of the point asked for.
  std::uint32_t node(std::uint32_t index, Frame frame, double lipschitz, std::int32_t material) {
    const Node& node = field_.nodes[index];
    frame = placed(node, frame);
    if (node.material >= 0) material = node.material;
    const double stated = states_for_all(node) ? node.lipschitz : 1.0;
    const std::uint32_t value = body(node, frame, lipschitz * stated, material);
    if (stated == 1.0) return value;
    return emit(Op::Scale, value, 0, lipschitz, {1.0 / stated});
  }

  /// Warps put the stated bound in the place of their own; of all others it is divided out.
  static bool states_for_all(const Node& node) {
    const bool warps = node.kind == Kind::Twist || node.kind == Kind::Bend ||
                       node.kind == Kind::Waves || node.kind == Kind::Noise;
    return node.lipschitz > 0.0 && !warps;
  }
  static double bound(const Node& node, double computed) {
    return node.lipschitz > 0.0 ? node.lipschitz : computed;
  }

  Frame placed(const Node& node, const Frame& frame) {
    const Placement placement = placement_of(field_, node, time_s_);
    const DVec3 offset = frame.offset + frame.scale * placement.at;
    const double scale = frame.scale * placement.scale;
    if (!placement.turned) return {frame.point, offset, scale};
    const DMat3 back = glm::transpose(placement.rotation);
    const DVec3 shift = -(back * offset);
    const std::uint32_t point =
        emit(Op::Affine, frame.point, 0, program_.code[frame.point].lipschitz,
             {back[0].x, back[1].x, back[2].x, shift.x, back[0].y, back[1].y, back[2].y, shift.y,
              back[0].z, back[1].z, back[2].z, shift.z});
    return {point, DVec3{0.0}, scale};
  }

  std::uint32_t body(const Node& node, const Frame& frame, double lipschitz,
                     std::int32_t material) {
    switch (node.kind) {
      case Kind::Union:
        return joined(node, frame, lipschitz, material, Op::Min, Op::SmoothMin);
      case Kind::Intersection:
        return joined(node, frame, lipschitz, material, Op::Max, Op::SmoothMax);
      case Kind::Difference:
        return joined(node, frame, lipschitz, material, Op::Difference, Op::SmoothDifference);
      case Kind::Repeat:
        return repeat(node, frame, lipschitz, material);
      case Kind::Mirror:
        return mirror(node, frame, lipschitz, material);
      case Kind::Twist:
        return turn(node, frame, lipschitz, material, Op::Twist);
      case Kind::Bend:
        return turn(node, frame, lipschitz, material, Op::Bend);
      case Kind::Shell:
        return emit(Op::Shell, children(node, frame, lipschitz, material), 0, lipschitz,
                    {frame.scale * value(node, 0).x});
      case Kind::Round:
        return emit(Op::Offset, children(node, frame, lipschitz, material), 0, lipschitz,
                    {frame.scale * value(node, 0).x});
      case Kind::Waves:
        return waves(node, frame, lipschitz, material);
      case Kind::Noise:
        return noise(node, frame, lipschitz, material);
      default:
        return primitive(node, frame, lipschitz, material);
    }
  }

  std::uint32_t joined(const Node& node, const Frame& frame, double lipschitz,
                       std::int32_t material, Op sharp, Op smooth) {
    const double k = frame.scale * value(node, 0).x;
    std::uint32_t result = 0;
    for (const std::uint32_t child : node.children) {
      const std::uint32_t each = this->node(child, frame, lipschitz, material);
      if (result == 0) {
        result = each;
      } else if (k > 0.0) {
        result = emit(smooth, result, each, lipschitz, {k, 1.0 / k, 0.25 * k});
      } else {
        result = emit(sharp, result, each, lipschitz, {});
      }
    }
    return result;
  }
  std::uint32_t children(const Node& node, const Frame& frame, double lipschitz,
                         std::int32_t material) {
    std::uint32_t result = 0;
    for (const std::uint32_t child : node.children) {
      const std::uint32_t each = this->node(child, frame, lipschitz, material);
      result = result == 0 ? each : emit(Op::Min, result, each, lipschitz, {});
    }
    return result;
  }

  std::uint32_t primitive(const Node& node, const Frame& f, double lipschitz,
                          std::int32_t material) {
    const double s = f.scale;
    const DVec3 c = f.offset, p0 = value(node, 0), p1 = value(node, 1), p2 = value(node, 2);
    const auto make_at = [&](std::uint32_t point, Op op, std::initializer_list<double> constants) {
      const std::uint32_t index = emit(op, point, 0, lipschitz, constants);
      program_.code[index].material = material;
      return index;
    };
    const auto make = [&](Op op, std::initializer_list<double> constants) {
      return make_at(f.point, op, constants);
    };
    const auto make_round = [&](Op op, std::initializer_list<double> constants) {
      return make_at(revolved(f), op, constants);
    };
    switch (node.kind) {
      case Kind::Sphere:
        return make(Op::Sphere, {c.x, c.y, c.z, s * p0.x});
      case Kind::Box: {
        const double edge = s * std::min({p1.x, p0.x, p0.y, p0.z});
        const DVec3 half = s * p0 - edge;
        return make(Op::Box, {c.x, c.y, c.z, half.x, half.y, half.z, edge});
      }
      case Kind::Torus:
        return make_round(Op::Torus, {c.y, s * p0.x, s * p1.x});
      case Kind::Cylinder: {
        const double edge = s * std::min({p2.x, p0.x, p1.x});
        return make_round(Op::Cylinder, {c.y, s * p0.x - edge, s * p1.x - edge, edge});
      }
      case Kind::Cone: {
        const double bottom = s * p0.x, top = s * p1.x, half = s * p2.x, side = top - bottom;
        const double square = side * side + 4.0 * half * half;
        return make_round(Op::Cone, {c.y, bottom, top, half, side, 2.0 * half, 1.0 / square});
      }
      case Kind::Capsule: {
        const DVec3 from = c + s * p0, axis = s * (p1 - p0);
        const double square = glm::dot(axis, axis);
        return make(Op::Capsule, {from.x, from.y, from.z, axis.x, axis.y, axis.z,
                                  square > 0.0 ? 1.0 / square : 0.0, s * p2.x});
      }
      case Kind::Plane: {
        const DVec3 n = glm::normalize(p0);
        return make(Op::Plane, {n.x, n.y, n.z, -glm::dot(n, c)});
      }
      case Kind::Ellipsoid:
        return make(Op::Ellipsoid, {c.x, c.y, c.z, 1.0 / (s * p0.x), 1.0 / (s * p0.y),
                                    1.0 / (s * p0.z), s * std::min({p0.x, p0.y, p0.z})});
      case Kind::Octahedron:
        return make(Op::Octahedron, {c.x, c.y, c.z, s * p0.x});
      case Kind::HexPrism:
        return make(Op::HexPrism, {c.x, c.y, c.z, s * p0.x, s * p1.x});
      default:
        break;
    }
    MACULA_CHECK(false, "a kind without a primitive");
    return 0;
  }

  /// The point of what is round about the frame's y axis: that of the primitive before, where both
  /// stand about one line.
  std::uint32_t revolved(const Frame& frame) {
    const auto x = static_cast<float>(frame.offset.x), z = static_cast<float>(frame.offset.z);
    if (last_revolved_ != 0) {
      const Instruction& last = program_.code[last_revolved_];
      const float* k = program_.constants.data() + last.constants;
      if (last.a == frame.point && k[0] == x && k[1] == z) return last_revolved_;
    }
    last_revolved_ = emit(Op::Revolve, frame.point, 0, program_.code[frame.point].lipschitz,
                          {frame.offset.x, frame.offset.z});
    return last_revolved_;
  }

  // An endless axis is brought near the eye in double; what is left needs few cells.
  std::uint32_t repeat(const Node& node, const Frame& frame, double lipschitz,
                       std::int32_t material) {
    const DVec3 period = frame.scale * value(node, 0);
    const bool alternates = value(node, 3).x > 0.5;
    DVec3 offset = frame.offset, first = value(node, 1), last = value(node, 2), inverse{0.0};
    for (int axis = 0; axis < 3; ++axis) {
      if (!(period[axis] > 0.0)) {
        first[axis] = last[axis] = 0.0;
        continue;
      }
      inverse[axis] = 1.0 / period[axis];
      const double cycle = (alternates ? 2.0 : 1.0) * period[axis];
      if (first[axis] < -kLastCell && last[axis] > kLastCell)
        offset[axis] -= cycle * std::round(offset[axis] / cycle);
      first[axis] = std::max(std::ceil(first[axis]), -kLastCell);
      last[axis] = std::min(std::floor(last[axis]), kLastCell);
    }
    const std::uint32_t point = emit(
        Op::Repeat, frame.point, 0, program_.code[frame.point].lipschitz,
        {offset.x, offset.y, offset.z, period.x, period.y, period.z, inverse.x, inverse.y,
         inverse.z, first.x, first.y, first.z, last.x, last.y, last.z, alternates ? 1.0 : 0.0});
    const std::uint32_t inner =
        children(node, {point, DVec3{0.0}, frame.scale}, lipschitz, material);
    if (alternates) return inner;
    return guarded(node, frame, period, inner, point, lipschitz);
  }

  /// Without alternation neighbouring cells do not meet: what lies in them is cut off at `half`,
  /// and no step leads past the nearest point of a neighbour's content, which is at least the gap
  /// along a repeated axis, and at least as far as the content's extent along the others, away.
  std::uint32_t guarded(const Node& node, const Frame& frame, const DVec3& period,
                        std::uint32_t inner, std::uint32_t point, double lipschitz) {
    constexpr double kNever = 1e30;
    DVec3 reach{0.0}, half{kNever}, other{kNever}, apart{kNever};
    for (const std::uint32_t child : node.children) {
      const Extent each = extent_of(field_, child, time_s_);
      reach = glm::max(reach, frame.scale * glm::max(glm::abs(each.low), glm::abs(each.high)));
    }
    for (int axis = 0; axis < 3; ++axis) {
      if (period[axis] > 0.0) {
        half[axis] = std::min(reach[axis], kCellShare * period[axis]);
        apart[axis] = 0.5 * period[axis] - half[axis];
      } else {
        other[axis] = std::min(reach[axis], kNever);
      }
    }
    const DVec3 wall = 0.5 * period;
    return emit(Op::RepeatGuard, inner, point, lipschitz,
                {half.x, half.y, half.z, wall.x, wall.y, wall.z, apart.x, apart.y, apart.z, other.x,
                 other.y, other.z});
  }

  std::uint32_t mirror(const Node& node, const Frame& frame, double lipschitz,
                       std::int32_t material) {
    const DVec3 axes = value(node, 0), c = frame.offset;
    const std::uint32_t point =
        emit(Op::Mirror, frame.point, 0, program_.code[frame.point].lipschitz,
             {c.x, c.y, c.z, axes.x > 0.5 ? 1.0 : 0.0, axes.y > 0.5 ? 1.0 : 0.0,
              axes.z > 0.5 ? 1.0 : 0.0});
    return children(node, {point, DVec3{0.0}, frame.scale}, lipschitz, material);
  }

  // Points beyond `within_radius` of the axis are taken to it first: a projection onto a convex set
  // stretches nothing, so the bound at that radius holds everywhere.
  std::uint32_t turn(const Node& node, const Frame& frame, double lipschitz, std::int32_t material,
                     Op op) {
    const double radius = frame.scale * value(node, 1).x;
    const double rate = glm::radians(value(node, 0).x) / frame.scale;
    const double shear = std::abs(rate) * radius;
    const double own =
        op == Op::Twist ? 0.5 * shear + std::sqrt(1.0 + 0.25 * shear * shear) : 1.0 + shear;
    const double lambda = bound(node, own);
    const DVec3 c = frame.offset;
    const std::uint32_t point =
        emit(op, frame.point, 0, lambda * program_.code[frame.point].lipschitz,
             {c.x, c.y, c.z, rate, radius});
    const std::uint32_t inner =
        children(node, {point, DVec3{0.0}, frame.scale}, lipschitz * lambda, material);
    return emit(Op::RadiusGuard, inner, frame.point, lipschitz,
                {c.x, c.y, c.z, 1.0 / lambda, radius, op == Op::Twist ? 1.0 : 0.0});
  }

  std::uint32_t waves(const Node& node, const Frame& frame, double lipschitz,
                      std::int32_t material) {
    const double amplitude = frame.scale * value(node, 0).x;
    const DVec3 wave = frame.scale * value(node, 1), k = 2.0 * kPi / wave;
    // The gradient of a sin sin sin is longest where two sines are 1: a times the largest k.
    const double lambda = bound(node, 1.0 + amplitude * std::max({k.x, k.y, k.z}));
    const DVec3 c = frame.offset - wave * glm::round(frame.offset / wave);
    return emit(Op::Waves, children(node, frame, lipschitz, material), frame.point, lipschitz,
                {c.x, c.y, c.z, k.x, k.y, k.z, amplitude, 1.0 / lambda});
  }

  std::uint32_t noise(const Node& node, const Frame& frame, double lipschitz,
                      std::int32_t material) {
    const double amplitude = frame.scale * value(node, 0).x;
    const double frequency = 1.0 / (frame.scale * value(node, 1).x);
    const double octaves = std::round(value(node, 2).x), gain = value(node, 3).x;
    double slope = 0.0, sum = 0.0, share = 1.0;
    for (int octave = 0; octave < static_cast<int>(octaves); ++octave, share *= gain) {
      slope += share * kNoiseSlope * std::exp2(octave);
      sum += share;
    }
    const double lambda = bound(node, 1.0 + amplitude * frequency * slope);
    const DVec3 c = frame.offset;
    return emit(Op::Noise, children(node, frame, lipschitz, material), frame.point, lipschitz,
                {c.x, c.y, c.z, frequency, amplitude, octaves, gain, value(node, 4).x, 1.0 / lambda,
                 amplitude * sum});
  }

  DVec3 value(const Node& node, std::size_t i) const {
    return field_.at(node.parameters[i], time_s_);
  }

  std::uint32_t emit(Op op, std::uint32_t a, std::uint32_t b, double lipschitz,
                     std::initializer_list<double> constants) {
    Instruction instruction{op, a, b, static_cast<std::uint32_t>(program_.constants.size())};
    instruction.lipschitz = static_cast<float>(lipschitz);
    for (const double constant : constants)
      program_.constants.push_back(static_cast<float>(constant));
    program_.code.push_back(instruction);
    return static_cast<std::uint32_t>(program_.code.size() - 1);
  }

  const Field& field_;
  double time_s_;
  Program program_;
  std::uint32_t last_revolved_ = 0;  ///< the last Op::Revolve; 0: none yet
};

}  // namespace

Program compile(const Field& field, double time_s, const DVec3& eye) {
  return Compiler(field, time_s).run(eye);
}

}  // namespace macula::sdf
