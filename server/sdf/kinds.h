// The visible table of node kinds: their names in files, their parameters, units, defaults and
// ranges. The reader, the compiler and the schema in README.md follow it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace macula::sdf {

enum class Kind : std::uint8_t {
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
  Union,
  Intersection,
  Difference,
  Repeat,
  Mirror,
  Twist,
  Bend,
  Shell,
  Round,
  Waves,
  Noise,
};

inline constexpr std::size_t kMaxParameters = 5;

enum class Shape : std::uint8_t { Scalar, Vector };

/// A parameter of a kind. Values must lie in [low, high], per component.
struct ParameterRule {
  std::string_view key;
  Shape shape = Shape::Scalar;
  std::optional<double> standard;  ///< none: the file must say it
  double low = 0.0, high = 1e12;
};

enum class Arity : std::uint8_t { Primitive, Several };

struct KindRule {
  Kind kind;
  std::string_view name;
  Arity arity;
  std::span<const ParameterRule> parameters;  ///< in the order of Node::parameters
};

std::span<const KindRule> kind_rules();
const KindRule& rule_of(Kind kind);
/// Nothing for a name the table does not know.
const KindRule* find_kind(std::string_view name);

}  // namespace macula::sdf
