// FieldRays: closest hits and occlusion among the surfaces of a distance field at one moment, in
// the words of visibility::TriangleScene, for kernels that light whatever rays meet. Plain sphere
// tracing of the whole expression, any origins, any directions; the eye's own rays go faster
// through sdf::Tracer. World space, meters, float. Immutable; safe from any number of threads at
// once.
#pragma once

#include "server/sdf/tape.h"
#include "server/visibility/visibility.h"

namespace macula::kernels {

class FieldRays {
 public:
  /// Keyframes are taken at `time_s`.
  FieldRays(const sdf::Field& field, double time_s);
  FieldRays(const FieldRays&) = delete;  // the tape looks into the program
  FieldRays& operator=(const FieldRays&) = delete;

  /// The closest hit of rays[0 .. count): `instance` is the material's index, `triangle`, u and v
  /// are 0. A ray is on a surface where the field falls below 2^-14 of the way it has come, a
  /// twentieth of half a pixel in usual pictures; one that begins in a solid is there at once and
  /// looks back along itself. Nothing is met by rays that are not finite, run out of steps, or come
  /// to where the field is not a number. Lanes idle and met as in visibility::RayStream.
  void intersect(const visibility::RayStream& rays, visibility::HitStream& hits) const;
  /// Rays that run out of steps creep along a surface: they count as occluded.
  void occluded(const visibility::RayStream& rays, visibility::OcclusionStream& result) const;

  /// One ray: as costly as sixteen of a stream.
  std::optional<visibility::Hit> intersect(const visibility::Ray& ray) const;
  bool occluded(const visibility::Ray& ray) const;

  /// Gap (visibility::Hit) of points that others found, known to a twentieth of half of `width_m`.
  static float gap_at(float width_m) { return 0.1F * width_m; }

 private:
  sdf::Program program_;
  sdf::Tape tape_;
};

}  // namespace macula::kernels
