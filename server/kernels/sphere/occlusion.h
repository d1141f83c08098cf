// Occlusion: how much of a light or of the sky reaches points on a distance field, by sphere
// tracing the whole expression. Positions relative to the program's eye, meters. Immutable but for
// the registers: one object a thread.
#pragma once

#include <cstdint>

#include "server/kernels/sphere/config.h"
#include "server/kernels/sphere/surface_batch.h"
#include "server/sdf/evaluate.h"

namespace macula::kernels::sphere {

/// What shading asked of the field and what it made that is no number.
struct ShadeWork {
  std::uint64_t shadow_rays = 0;        ///< towards lights and the sky
  std::uint64_t field_evaluations = 0;  ///< for these and along normals
  std::uint64_t field_operations = 0;   ///< lane operations of them
  std::uint64_t non_finite = 0;         ///< samples replaced by black

  ShadeWork& operator+=(const ShadeWork& other) {
    shadow_rays += other.shadow_rays, field_evaluations += other.field_evaluations;
    field_operations += other.field_operations, non_finite += other.non_finite;
    return *this;
  }
};

class Occlusion {
 public:
  /// `program` must outlive it.
  explicit Occlusion(const sdf::Program& program)
      : tape_(sdf::make_tape(program)),
        operations_(sdf::operations_of(tape_)),
        far_m_(program.far_m) {}

  /// Shares, in [0, 1], of light from `to_light` (unit) at `distance_m` (+infinity: a sun) that
  /// reach the points; entries whose `wanted` is 0 are left alone. tan_radius 0: 0 or 1.
  void light(const SurfaceBatch& points, const sampling::Vec3Batch& to_light,
             const sampling::FloatBatch& distance_m, float tan_radius,
             const sampling::FloatBatch& wanted, sampling::FloatBatch& reaching);
  /// SkyLight::Near.
  void near_sky(const SurfaceBatch& points, float reach_m, sampling::FloatBatch& reaching);
  /// Everything asked so far.
  const ShadeWork& work() const { return work_; }

 private:
  struct Lanes;
  void march(Lanes& lanes, float tan_radius, sampling::FloatBatch& reaching);
  /// Distances at the first positions_ into found_.
  void measure(std::size_t count);

  sdf::Tape tape_;
  std::size_t operations_;
  float far_m_;
  ShadeWork work_;
  sdf::Registers registers_;
  sdf::PointBatch positions_{};
  sdf::DistanceBatch found_{};
};

/// How far off its surface a ray from a point starts: beyond what the tracer calls a hit there.
float surface_gap(const SurfaceBatch& points, std::size_t i);

}  // namespace macula::kernels::sphere
