#include "server/disocclusion/hidden_sights.h"

#include <limits>

namespace macula::disocclusion {
namespace {

/// Surfaces of one object behind each other before a ray gives up.
constexpr int kMostSurfaces = 8;

/// Twice what two triangles that share an edge may differ by at one hit.
float just_beyond(float t) {
  constexpr float kUlps = 8.0F * std::numeric_limits<float>::epsilon();
  return t * (1.0F + kUlps);
}

/// The side a ray meets: positive from the front.
float facing(const visibility::RayStream& rays, const visibility::HitStream& hits, int i) {
  return -glm::dot(hits.normal(i), rays.direction(i));
}

/// What stands before tnear.
void find_fronts(const visibility::TriangleScene& triangles, const visibility::RayStream& rays,
                 visibility::HitStream& fronts) {
  visibility::RayStream before = rays;
  for (int i = 0; i < rays.count; ++i) {
    before.tnear[i] = 0.0F;
    before.tfar[i] = rays.tnear[i];
  }
  triangles.intersect(before, fronts, visibility::Coherence::Coherent);
}

}  // namespace

void walk_surfaces(const visibility::TriangleScene& triangles, HiddenSights& sights) {
  visibility::HitStream fronts, found;
  find_fronts(triangles, sights.rays, fronts);
  visibility::RayStream rays = sights.rays;
  for (int i = 0; i < rays.count; ++i) sights.hits.instance[i] = visibility::kNothing;
  for (int round = 0; round < kMostSurfaces; ++round) {
    triangles.intersect(rays, found, visibility::Coherence::Coherent);
    bool any = false;
    for (int i = 0; i < rays.count; ++i) {
      if (!(rays.tnear[i] <= rays.tfar[i])) continue;  // has ended
      const bool inside = found.hit(i) && fronts.hit(i) &&
                          found.instance[i] == fronts.instance[i] &&
                          (facing(rays, found, i) > 0.0F) != (facing(rays, fronts, i) > 0.0F);
      if (inside) {
        rays.tnear[i] = just_beyond(found.t[i]);
        any = true;
        continue;
      }
      if (found.hit(i)) set_hit(sights.hits, i, found.at(i));
      rays.tfar[i] = -1.0F;
    }
    if (!any) return;
  }
}

}  // namespace macula::disocclusion
