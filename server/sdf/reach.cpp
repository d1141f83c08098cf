#include "server/sdf/reach.h"

#include <algorithm>
#include <cmath>

namespace macula::sdf {
namespace {

/// A point register as a rigid motion of the point asked for; what is revolved stands about a line
/// along y through (axis_x, axis_z) of that motion's space.
struct Motion {
  DMat3 rotation{1.0};
  DVec3 shift{0.0};
  double axis_x = 0.0, axis_z = 0.0;

  DVec3 back(const DVec3& own) const { return glm::transpose(rotation) * (own - shift); }
};

Ball enclosing(const Ball& a, const Ball& b) {
  const Vec3 across = b.centre - a.centre;
  const float apart = glm::length(across);
  if (apart + b.radius <= a.radius) return a;
  if (apart + a.radius <= b.radius) return b;
  const float radius = 0.5F * (apart + a.radius + b.radius);
  return {a.centre + (radius - a.radius) / apart * across, radius};
}

class Survey {
 public:
  explicit Survey(const Program& program)
      : code_(program.code),
        constants_(program.constants),
        motions_(program.code.size()),
        reaches_(program.code.size()) {}

  std::vector<std::optional<Reach>> run() {
    motions_[0] = Motion{};
    for (std::size_t i = 1; i < code_.size(); ++i) {
      if (makes_point(code_[i].op)) {
        motions_[i] = motion(code_[i]);
      } else {
        reaches_[i] = is_primitive(code_[i].op) ? primitive(code_[i]) : combined(code_[i]);
      }
    }
    return std::move(reaches_);
  }

 private:
  const float* constants(const Instruction& code) const {
    return constants_.data() + code.constants;
  }

  std::optional<Motion> motion(const Instruction& code) const {
    const std::optional<Motion>& from = motions_[code.a];
    if (!from) return std::nullopt;
    const float* k = constants(code);
    Motion result = *from;
    if (code.op == Op::Revolve) {
      result.axis_x = k[0], result.axis_z = k[1];
      return result;
    }
    if (code.op != Op::Affine) return std::nullopt;
    const DMat3 turn{DVec3{k[0], k[4], k[8]}, DVec3{k[1], k[5], k[9]}, DVec3{k[2], k[6], k[10]}};
    result.rotation = turn * from->rotation;
    result.shift = turn * from->shift + DVec3{k[3], k[7], k[11]};
    return result;
  }

  std::optional<Reach> primitive(const Instruction& code) const {
    const std::optional<Motion>& motion = motions_[code.a];
    if (!motion) return std::nullopt;
    const float* k = constants(code);
    const Vec3 own{k[0], k[1], k[2]};
    const auto around = [&](const Vec3& centre, float radius, float rate = 1.0F) {
      return Reach{{Vec3(motion->back(DVec3(centre))), radius}, rate};
    };
    const auto on_axis = [&](float y, float radius) {
      return around(Vec3(motion->axis_x, y, motion->axis_z), radius);
    };
    switch (code.op) {
      case Op::Sphere:
        return around(own, k[3]);
      case Op::Box:
        return around(own, glm::length(Vec3{k[3], k[4], k[5]}) + k[6]);
      case Op::Torus:
        return on_axis(k[0], k[1] + k[2]);
      case Op::Cylinder:
        return on_axis(k[0], std::hypot(k[1], k[2]) + k[3]);
      case Op::Cone:
        return on_axis(k[0], std::hypot(std::max(k[1], k[2]), k[3]));
      case Op::Capsule: {
        const Vec3 axis{k[3], k[4], k[5]};
        return around(own + 0.5F * axis, 0.5F * glm::length(axis) + k[7]);
      }
      case Op::Ellipsoid: {
        // |p / radii| is at least |p| over the largest radius.
        const float largest = 1.0F / std::min({k[3], k[4], k[5]});
        return around(own, largest, k[6] / largest);
      }
      case Op::Octahedron:  // the sum of absolute values is at least the length
        return around(own, k[3], 0.57735F);
      case Op::HexPrism:
        return around(own, std::hypot(1.15471F * k[3], k[4]));
      default:
        return std::nullopt;
    }
  }

  std::optional<Reach> combined(const Instruction& code) const {
    const float* k = constants(code);
    const std::optional<Reach>& a = reaches_[code.a];
    switch (code.op) {
      case Op::Min:
        return either(a, reaches_[code.b], 0.0F);
      case Op::SmoothMin:
        return either(a, reaches_[code.b], k[2]);
      case Op::Max:
      case Op::SmoothMax:
        return both(a, reaches_[code.b]);
      case Op::Difference:
      case Op::SmoothDifference:
        return a;
      case Op::Offset:
      case Op::Shell:
        return lowered(a, k[0], 1.0F);
      case Op::Scale:
        return lowered(a, 0.0F, k[0]);
      case Op::Waves:
        return lowered(a, k[6], k[7]);
      case Op::Noise:
        return lowered(a, k[9], k[8]);
      default:
        return std::nullopt;
    }
  }
  /// The lesser of two, less at most `blend`.
  static std::optional<Reach> either(const std::optional<Reach>& a, const std::optional<Reach>& b,
                                     float blend) {
    if (!a || !b) return std::nullopt;
    return lowered(Reach{enclosing(a->ball, b->ball), std::min(a->rate, b->rate)}, blend, 1.0F);
  }
  /// The greater of two: it ends where one of them does.
  static std::optional<Reach> both(const std::optional<Reach>& a, const std::optional<Reach>& b) {
    if (!a || !b) return a ? a : b;
    return a->ball.radius <= b->ball.radius ? a : b;
  }
  /// (a - by) * factor
  static std::optional<Reach> lowered(const std::optional<Reach>& a, float by, float factor) {
    if (!a) return std::nullopt;
    return Reach{{a->ball.centre, a->ball.radius + by / a->rate}, a->rate * factor};
  }

  const std::vector<Instruction>& code_;
  const std::vector<float>& constants_;
  std::vector<std::optional<Motion>> motions_;  ///< by instruction, of points
  std::vector<std::optional<Reach>> reaches_;   ///< by instruction, of distances
};

}  // namespace

std::vector<std::optional<Reach>> reaches_of(const Program& program) {
  return Survey(program).run();
}

}  // namespace macula::sdf
