// Light as rays that leave it, drawn so that every ray of an untextured light carries the same
// flux. World space, meters, linear Rec.709. Pure functions of points in [0, 1)^2; low-discrepancy
// points give evenly spread rays.
#pragma once

#include "server/lights/light_list.h"

namespace macula::lights {

struct LightRay {
  DVec3 origin{0.0};            ///< of the ray; on the light, or nearer to what it lights
  Vec3 surface_normal{0.0F};    ///< unit, of the lamp the ray leaves; 0 where it leaves none
  float surface_span_m = 0.0F;  ///< shading::Surface's, for the ray's offset
  Vec3 direction{0.0F};         ///< unit, the way the light travels
  /// W, the ray's flux over the density it was drawn with: the mean over rays is the flux that
  /// leaves the light, so one of n carries an n-th of it.
  Rgb flux{0.0F};
};

/// From a punctual light. Point: all directions; from outside the ball about `lit` those that meet
/// it, starting just before it, so that flux is what enters the ball. Spot: its cone, more where it
/// shines more. Directional: from the disc before `lit` that covers it, so that flux is what
/// crosses the disc; none with nothing to light.
LightRay ray_from(const scene::Light& light, const scene::Bounds& lit, const Vec2& u);

/// From a point of some emissive triangle, as sample_area draws it, by the cosine about its normal.
/// Only for a list with emissive triangles.
LightRay ray_from_area(const LightList& list, const Vec2& u_place, const Vec2& u_direction,
                       const shading::SurfaceTable& surfaces,
                       const shading::MaterialTable& materials);

}  // namespace macula::lights
