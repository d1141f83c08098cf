// A rigid transform in double: poses are differences of large numbers more often than not.
// Named target-from-source, e.g. `Pose world_from_head`. Frames and units: frames.h.
#pragma once

#include "shared/math/vec.h"
#include "shared/units/angle.h"

namespace macula::math {

struct Pose {
  DVec3 position{0.0};                 ///< source origin in the target frame, meters
  DQuat rotation{1.0, 0.0, 0.0, 0.0};  ///< unit quaternion, rotates source directions into target

  DVec3 transform_point(const DVec3& point) const { return position + rotation * point; }
  DVec3 transform_direction(const DVec3& direction) const { return rotation * direction; }
};

/// a_from_b * b_from_c = a_from_c.
Pose operator*(const Pose& a_from_b, const Pose& b_from_c);
Pose inverse(const Pose& a_from_b);
/// Position linearly, rotation along the shorter arc; t = 0 gives a, 1 gives b; t outside
/// extrapolates.
Pose interpolate(const Pose& a, const Pose& b, double t);
/// Rotation angle between the orientations of two poses, in [0, 180] degrees.
Radians angle_between(const Pose& a, const Pose& b);
/// A view at `eye` that looks at `target`; `up` need not be perpendicular. All in world meters.
Pose look_at(const DVec3& eye, const DVec3& target, const DVec3& up);
/// Finite everywhere, |rotation| within 1e-3 of 1, |position| below 1e7 m (coordinates lose
/// millimeters in float far beyond that).
bool is_valid(const Pose& pose);

}  // namespace macula::math

namespace macula {
using math::Pose;
}
