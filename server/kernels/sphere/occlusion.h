// Occlusion: how much of a light or of the sky reaches points on a distance field, by sphere
// tracing the whole expression. Positions relative to the program's eye, meters. Immutable but for
// the registers: one object a thread.
#pragma once

#include "server/kernels/sphere/config.h"
#include "server/kernels/sphere/surface_batch.h"
#include "server/sdf/evaluate.h"

namespace macula::kernels::sphere {

class Occlusion {
 public:
  /// `program` must outlive it.
  explicit Occlusion(const sdf::Program& program)
      : tape_(sdf::make_tape(program)), far_m_(program.far_m) {}

  /// Shares, in [0, 1], of light from `to_light` (unit) at `distance_m` (+infinity: a sun) that
  /// reach the points; entries whose `wanted` is 0 are left alone. tan_radius 0: 0 or 1.
  void light(const SurfaceBatch& points, const sampling::Vec3Batch& to_light,
             const sampling::FloatBatch& distance_m, float tan_radius,
             const sampling::FloatBatch& wanted, sampling::FloatBatch& reaching);
  /// SkyLight::Near.
  void near_sky(const SurfaceBatch& points, float reach_m, sampling::FloatBatch& reaching);

 private:
  struct Lanes;
  void march(Lanes& lanes, float tan_radius, sampling::FloatBatch& reaching);

  sdf::Tape tape_;
  float far_m_;
  sdf::Registers registers_;
  sdf::PointBatch positions_{};
  sdf::DistanceBatch found_{};
};

/// How far off its surface a ray from a point starts: beyond what the tracer calls a hit there.
float surface_gap(const SurfaceBatch& points, std::size_t i);

}  // namespace macula::kernels::sphere
