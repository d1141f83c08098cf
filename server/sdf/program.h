// Program: a field at one moment seen from one eye, as a flat list of operations in which every
// result is written once. Constants are floats relative to the eye (differences are taken in
// double), so distance from the scene's origin costs no precision. Positions given to a program
// are relative to that eye, in the scene's orientation, meters. Immutable.
#pragma once

#include <cstdint>
#include <vector>

#include "server/sdf/field.h"

namespace macula::sdf {

enum class Op : std::uint8_t {
  Input,  ///< the point asked for; always the first instruction
  // Points from points.
  Affine,
  Repeat,
  Mirror,
  Twist,
  Bend,
  Revolve,  ///< (distance from a line along y, y): shared by what is round about it
  // Distances from points.
  Sphere,
  Box,
  Torus,
  Cylinder,
  Cone,
  Capsule,
  Plane,
  Ellipsoid,
  Octahedron,
  HexPrism,
  // Distances from two distances.
  Min,
  Max,
  Difference,
  SmoothMin,
  SmoothMax,
  SmoothDifference,
  // Distances from one distance.
  Offset,
  Shell,
  Scale,
  // Distances from a distance and the point it stands at.
  Waves,
  Noise,
  RepeatGuard,
  RadiusGuard,
};

constexpr bool makes_point(Op op) {
  return op <= Op::Revolve;
}
constexpr bool is_primitive(Op op) {
  return op >= Op::Sphere && op <= Op::HexPrism;
}
constexpr bool joins_two(Op op) {
  return op >= Op::Min && op <= Op::SmoothDifference;
}
constexpr bool needs_distance_and_point(Op op) {
  return op >= Op::Waves;
}

constexpr bool reads_two(Op op) {
  return joins_two(op) || needs_distance_and_point(op);
}

/// `a` and `b` are indices of earlier instructions: a point for points and primitives; two
/// distances; or a distance (a) and a point (b).
struct Instruction {
  Op op = Op::Input;
  std::uint32_t a = 0, b = 0;
  std::uint32_t constants = 0;  ///< where this instruction's constants begin
  std::int32_t material = 0;    ///< of primitives
  float lipschitz = 1.0F;       ///< of this value as a function of the point asked for
};

struct Program {
  std::vector<Instruction> code;  ///< the last one is the field
  std::vector<float> constants;
  DVec3 eye{0.0};      ///< scene meters
  float far_m = 0.0F;  ///< rays end here
};

/// Keyframes are taken at `time_s`. Cheap: a pass over the nodes.
Program compile(const Field& field, double time_s, const DVec3& eye);

/// Axis-aligned and conservative, in the coordinates of the node's parent; infinite where the node
/// is.
struct Extent {
  DVec3 low, high;
};
Extent extent_of(const Field& field, std::uint32_t node, double time_s);

}  // namespace macula::sdf
