// Field: a signed distance scene as data, as its file says it, keyframes included. Immutable once
// read. Meters, seconds on the scene's clock, frames of shared/math/frames.h. Nodes refer to their
// children by index and children stand before their parents; the root is the last node.
//
// Every node is 1-Lipschitz where it stands: a node whose operation stretches space divides its
// value by its own bound lambda >= 1. A bound that a file states replaces the computed one.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "server/sdf/kinds.h"
#include "shared/image/color.h"
#include "shared/math/pose.h"
#include "shared/units/angle.h"

namespace macula::sdf {

/// Values over time, linear between keys; before the first and after the last key they hold, or
/// repeat with the period of the whole track. Scalars use x.
struct Track {
  std::vector<double> times_s;  ///< strictly increasing, at least one
  std::vector<DVec3> values;    ///< as many as times_s
  bool loops = false;

  DVec3 at(double time_s) const;
};

struct Parameter {
  DVec3 value{0.0};
  std::int32_t track = -1;  ///< index into Field::tracks, or -1: constant
};

struct Node {
  Kind kind = Kind::Union;
  std::string name;  ///< for messages; may be empty
  std::array<Parameter, kMaxParameters> parameters;
  Parameter at;                         ///< position in the parent's coordinates
  Parameter rotate_deg;                 ///< about x, then y, then z of the parent
  Parameter scale{DVec3{1.0}, -1};      ///< uniform, x used
  double lipschitz = 0.0;               ///< stated bound >= 1, or 0: computed
  std::int32_t material = -1;           ///< index into Field::materials; -1: the parent's
  std::vector<std::uint32_t> children;  ///< empty for primitives
};

/// Where a material changes over a surface. Coordinates are the scene's, in meters.
enum class Pattern { None, Checker, Noise, Bricks, Stripes };

struct Material {
  std::string name;
  Rgb color{0.8F};   ///< linear reflectance, [0, 1]
  Rgb second{0.2F};  ///< the other color of the pattern
  Pattern pattern = Pattern::None;
  float pattern_size_m = 1.0F;  ///< edge of a checker square, period of the noise, ...
  float roughness = 1.0F;       ///< perceptual, [0, 1]; 1 = matte
  float metallic = 0.0F;
  Rgb emission{0.0F};  ///< radiance, W/(sr m^2)
};

struct PointLight {
  std::string name;
  Parameter position;   ///< scene meters
  Parameter intensity;  ///< W/sr, linear Rec.709
};
struct Sun {
  Vec3 direction{0.0F, -1.0F, 0.0F};  ///< unit, the way the light travels
  Rgb irradiance{0.0F};               ///< W/m^2
};

struct Camera {
  std::string name;
  Parameter eye, target;
  DVec3 up{0.0, 1.0, 0.0};
  Radians vertical_fov{Degrees{60.0}};
};

struct Field {
  std::string name;
  std::vector<Node> nodes;
  std::vector<Track> tracks;
  std::vector<Material> materials;  ///< at least one; 0 is what nodes without a material get
  std::vector<PointLight> lights;
  std::vector<Sun> suns;
  std::vector<Camera> cameras;
  Rgb sky{0.0F};       ///< radiance where nothing is hit, and constant ambient light
  double far_m = 1e3;  ///< rays end here
  double exposure_ev = 0.0;

  DVec3 at(const Parameter& parameter, double time_s) const;
  Pose pose_of(const Camera& camera, double time_s) const;
  /// Whether any parameter has keys: the field, a light or a camera moves.
  bool moves() const { return !tracks.empty(); }
};

/// Moves the root, the lights and the cameras; patterns stay where they are in the world. Every
/// track belongs to one parameter.
void translate(Field& field, const DVec3& by);

}  // namespace macula::sdf
