// From the unit square to other domains, area-preserving, so that stratified points stay
// stratified. Input in [0, 1)^2. Directions are in a local frame with the normal along +Z; pdfs are
// per solid angle or per area of the target. Pure functions.
#pragma once

#include "server/sampling/batch.h"
#include "shared/math/vec.h"

namespace macula::sampling {

/// Unit disk, pdf 1/pi. Concentric map of Shirley and Chiu (1997).
Vec2 uniform_disk(const Vec2& u);
/// Directions with z >= 0, pdf z/pi (Malley's method on the concentric map).
Vec3 cosine_hemisphere(const Vec2& u);
/// Directions with z >= 0, pdf 1/(2 pi).
Vec3 uniform_hemisphere(const Vec2& u);
/// All directions, pdf 1/(4 pi).
Vec3 uniform_sphere(const Vec2& u);
/// Barycentrics (b1, b2) of vertices 1 and 2, b1, b2, 1 - b1 - b2 >= 0, pdf 1/area.
/// Low-distortion map of Heitz (2019).
Vec2 uniform_triangle(const Vec2& u);

/// `count` directions about `normals`, each cosine_hemisphere in the frame of frame.h, mirrored at
/// the plane of its unit vector of `sides` where it lies behind that.
void cosine_directions(const Vec2Batch& u, const Vec3Batch& normals, const Vec3Batch& sides,
                       std::size_t count, Vec3Batch& directions);

}  // namespace macula::sampling
