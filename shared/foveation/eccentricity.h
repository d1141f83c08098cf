// Eccentricity: the angle between a view ray and the gaze ray, per eye, by atan2(|g x d|, g.d).
// acos loses half the digits near 0 and a planar distance is right only for a gaze on the axis.
#pragma once

#include "shared/math/vec.h"
#include "shared/units/angle.h"

namespace macula::foveation {

/// Neither vector need be normalised; both finite and not zero. Result in [0, pi].
Radians eccentricity(const Vec3& gaze, const Vec3& direction);
Radians eccentricity(const DVec3& gaze, const DVec3& direction);

}  // namespace macula::foveation
