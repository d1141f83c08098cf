// The conventions of the whole project, stated once and pinned by
// tests/shared/math/frames_test.cpp.
//
// World, stage, head and view frames are right-handed, in meters: +X right, +Y up, and a view looks
// down -Z (as in OpenXR). Transforms read target-from-source: `world_from_view` maps view-space
// points to the world, and a_from_b * b_from_c = a_from_c.
//
// Tangent plane of a view: the plane z = -1 with coordinates (x, y) = (d.x / -d.z, -d.y / -d.z).
// Its y points DOWN, so that x and y both grow along pixel columns and rows. A picture's origin is
// its top-left corner, rectangles are half-open, and the centre of pixel (i, j) lies at (i + 0.5, j
// + 0.5).
//
// View depth of a point is -z in view space, in meters; +infinity where nothing is hit. Radiance is
// linear Rec.709. A gaze is a unit vector in view space. Time is ServerTime or ClientTime.
#pragma once

#include "shared/math/vec.h"

namespace macula::math {

/// Direction (not normalised, z = -1) through a point of the tangent plane.
inline Vec3 direction_from_tangent(const Vec2& tangent) {
  return {tangent.x, -tangent.y, -1.0F};
}
inline DVec3 direction_from_tangent(const DVec2& tangent) {
  return {tangent.x, -tangent.y, -1.0};
}

/// Point of the tangent plane seen along `direction`; meaningful only for direction.z < 0.
inline Vec2 tangent_from_direction(const Vec3& direction) {
  return {direction.x / -direction.z, direction.y / direction.z};
}
inline DVec2 tangent_from_direction(const DVec3& direction) {
  return {direction.x / -direction.z, direction.y / direction.z};
}

}  // namespace macula::math
