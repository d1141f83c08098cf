// What moves in a scene, as data: keyframe tracks, the joints they turn, and meshes that change
// shape. Times are SceneTime, in seconds from the scene's own start; meters; right-handed.
// Immutable once in a Scene; animation.h poses them. Source: glTF 2.0, sections 3.11 and C.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/math/vec.h"
#include "shared/units/time.h"

namespace macula::scene {

using Index = std::uint32_t;

/// A moment on the scene's own clock, one for all sessions; 0 is where its tracks begin.
struct SceneTime {
  Nanoseconds since_start{0};
  friend auto operator<=>(const SceneTime&, const SceneTime&) = default;
};

/// Between two keys: the earlier one's value; on the straight line (rotations: the shorter arc at
/// constant speed); a cubic Hermite spline (rotations: its components, made unit again).
enum class Interpolation { Step, Linear, CubicSpline };

/// A value over time. Before the first key and after the last it holds theirs.
template <class Value>
struct Track {
  Interpolation interpolation = Interpolation::Linear;
  std::vector<double> times_s;  ///< strictly increasing
  /// One a key; CubicSpline: three, the tangent coming in (per second), the value, and the tangent
  /// going out.
  std::vector<Value> values;

  bool empty() const { return times_s.empty(); }
};

/// A frame that moves: instances, lights, cameras and other joints hang from it.
///   parent_from_joint(t) = parent_from_base * translation * rotation * scale
/// A track replaces its part; a part without one keeps its value at rest. A scale of 0 makes what
/// hangs from the joint vanish.
struct Joint {
  std::string name;
  std::optional<Index> parent;  ///< a smaller index; none: the world
  DMat4 parent_from_base{1.0};  ///< affine, still
  DVec3 translation{0.0};
  DQuat rotation{1.0, 0.0, 0.0, 0.0};  ///< unit
  DVec3 scale{1.0};
  Track<DVec3> translations;
  Track<DQuat> rotations;  ///< unit quaternions (CubicSpline: tangents of any length)
  Track<DVec3> scales;
  /// > 0: the tracks begin again after so long, for ever, also before time 0; a track that should
  /// close ends where it begins. 0: they run once and hold.
  Nanoseconds period{0};

  bool has_tracks() const { return !translations.empty() || !rotations.empty() || !scales.empty(); }
};

/// Whole sets of a mesh's vertices at times, linear between them; object space. Triangles, texture
/// coordinates and material stay those of the mesh.
struct Deformation {
  std::vector<double> times_s;               ///< strictly increasing; empty: the mesh is rigid
  std::vector<std::vector<Vec3>> positions;  ///< by key; each as many as Mesh::positions
  std::vector<std::vector<Vec3>> normals;    ///< by key, unit; empty where Mesh::normals is
  Nanoseconds period{0};                     ///< as Joint::period

  bool empty() const { return times_s.empty(); }
};

}  // namespace macula::scene
