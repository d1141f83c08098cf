#include "server/sdf/kinds.h"

#include <array>

#include "shared/base/check.h"

namespace macula::sdf {
namespace {

constexpr double kSmallest = 1e-12;  // m: what a length may be at least
constexpr double kLargest = 1e12;    // m

constexpr ParameterRule length(std::string_view key) {
  return {key, Shape::Scalar, std::nullopt, kSmallest, kLargest};
}
constexpr ParameterRule length_or(std::string_view key, double standard) {
  return {key, Shape::Scalar, standard, 0.0, kLargest};
}
constexpr ParameterRule lengths(std::string_view key) {
  return {key, Shape::Vector, std::nullopt, kSmallest, kLargest};
}
constexpr ParameterRule point(std::string_view key) {
  return {key, Shape::Vector, std::nullopt, -kLargest, kLargest};
}

constexpr std::array kSphere{length("radius")};
constexpr std::array kBox{lengths("half_size"), length_or("edge_radius", 0.0)};
constexpr std::array kTorus{length("radius"), length("tube_radius")};
constexpr std::array kCylinder{length("radius"), length("half_height"),
                               length_or("edge_radius", 0.0)};
constexpr std::array kCone{length_or("bottom_radius", 0.0), length_or("top_radius", 0.0),
                           length("half_height")};
constexpr std::array kCapsule{point("from"), point("to"), length("radius")};
constexpr std::array kPlane{ParameterRule{"normal", Shape::Vector, std::nullopt, -1.0, 1.0}};
constexpr std::array kEllipsoid{lengths("radii")};
constexpr std::array kOctahedron{length("radius")};
constexpr std::array kHexPrism{length("radius"), length("half_height")};
constexpr std::array kSmooth{length_or("smooth", 0.0)};
constexpr std::array kRepeat{ParameterRule{"period", Shape::Vector, std::nullopt, 0.0, kLargest},
                             ParameterRule{"first", Shape::Vector, -kLargest, -kLargest, kLargest},
                             ParameterRule{"last", Shape::Vector, kLargest, -kLargest, kLargest},
                             ParameterRule{"alternate", Shape::Scalar, 0.0, 0.0, 1.0}};
constexpr std::array kMirror{ParameterRule{"axes", Shape::Vector, std::nullopt, 0.0, 1.0}};
constexpr std::array kTurn{ParameterRule{"deg_per_m", Shape::Scalar, std::nullopt, -1e9, 1e9},
                           length("within_radius")};
constexpr std::array kShell{length("thickness")};
constexpr std::array kRound{length("radius")};
constexpr std::array kWaves{length_or("amplitude", 0.0), lengths("wavelength")};
constexpr std::array kNoise{length_or("amplitude", 0.0), length("cell"),
                            ParameterRule{"octaves", Shape::Scalar, 3.0, 1.0, 8.0},
                            ParameterRule{"gain", Shape::Scalar, 0.45, 0.0, 1.0},
                            ParameterRule{"seed", Shape::Scalar, 0.0, 0.0, 65535.0}};

constexpr std::array kRules{
    KindRule{Kind::Sphere, "sphere", Arity::Primitive, kSphere},
    KindRule{Kind::Box, "box", Arity::Primitive, kBox},
    KindRule{Kind::Torus, "torus", Arity::Primitive, kTorus},
    KindRule{Kind::Cylinder, "cylinder", Arity::Primitive, kCylinder},
    KindRule{Kind::Cone, "cone", Arity::Primitive, kCone},
    KindRule{Kind::Capsule, "capsule", Arity::Primitive, kCapsule},
    KindRule{Kind::Plane, "plane", Arity::Primitive, kPlane},
    KindRule{Kind::Ellipsoid, "ellipsoid", Arity::Primitive, kEllipsoid},
    KindRule{Kind::Octahedron, "octahedron", Arity::Primitive, kOctahedron},
    KindRule{Kind::HexPrism, "hex_prism", Arity::Primitive, kHexPrism},
    KindRule{Kind::Union, "union", Arity::Several, kSmooth},
    KindRule{Kind::Intersection, "intersection", Arity::Several, kSmooth},
    KindRule{Kind::Difference, "difference", Arity::Several, kSmooth},
    KindRule{Kind::Repeat, "repeat", Arity::Several, kRepeat},
    KindRule{Kind::Mirror, "mirror", Arity::Several, kMirror},
    KindRule{Kind::Twist, "twist", Arity::Several, kTurn},
    KindRule{Kind::Bend, "bend", Arity::Several, kTurn},
    KindRule{Kind::Shell, "shell", Arity::Several, kShell},
    KindRule{Kind::Round, "round", Arity::Several, kRound},
    KindRule{Kind::Waves, "waves", Arity::Several, kWaves},
    KindRule{Kind::Noise, "noise", Arity::Several, kNoise},
};

}  // namespace

std::span<const KindRule> kind_rules() {
  return kRules;
}

const KindRule& rule_of(Kind kind) {
  const KindRule& rule = kRules.at(static_cast<std::size_t>(kind));
  MACULA_CHECK(rule.kind == kind, "the table follows the order of Kind");
  return rule;
}

const KindRule* find_kind(std::string_view name) {
  for (const KindRule& rule : kRules) {
    if (rule.name == name) return &rule;
  }
  return nullptr;
}

}  // namespace macula::sdf
