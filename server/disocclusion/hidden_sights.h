// What lies behind the surfaces of some cells: rays through their centres, where to look from, and
// what was found. Internal to this room; one thread fills and reads it.
#pragma once

#include "server/sdf/tape.h"
#include "server/visibility/visibility.h"

namespace macula::disocclusion {

struct HiddenSights {
  /// World space; directions have length 1 along the view axis, so that t is view depth in meters.
  /// tnear: what is hidden lies beyond it.
  visibility::RayStream rays;
  visibility::HitStream hits;  ///< nothing: only what SceneFrame::beyond tells
};

inline void set_hit(visibility::HitStream& hits, int i, const visibility::Hit& hit) {
  hits.t[i] = hit.t, hits.u[i] = hit.u, hits.v[i] = hit.v;
  hits.nx[i] = hit.normal.x, hits.ny[i] = hit.normal.y, hits.nz[i] = hit.normal.z;
  hits.instance[i] = hit.instance, hits.triangle[i] = hit.triangle, hits.gap[i] = hit.gap;
}

/// The first surface beyond tnear that is not the inside of the object in front: of the instance
/// that the ray meets before tnear, surfaces that face the other way are passed over. Triangles.
void walk_surfaces(const visibility::TriangleScene& triangles, HiddenSights& sights);

/// The same in a distance field: a ray that begins in a solid leaves it first, and is clear of its
/// surface before it may meet another one.
class FieldWalk {
 public:
  /// Keyframes are taken at `time_s`.
  FieldWalk(const sdf::Field& field, double time_s);
  FieldWalk(const FieldWalk&) = delete;  // the tape looks into the program
  FieldWalk& operator=(const FieldWalk&) = delete;

  void find(HiddenSights& sights) const;

 private:
  sdf::Program program_;
  sdf::Tape tape_;
};

}  // namespace macula::disocclusion
