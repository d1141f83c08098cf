// ReflectorBatch: up to sampling::kBatch Reflectors side by side, each evaluated for a direction of
// its own, in vectors. Directions: unit, world. Agrees with Reflector::evaluate, its oracle, within
// 2e-4 of the value for alpha >= 0.1 (tested): the albedo table is read in 16 bits here.
#pragma once

#include "server/sampling/batch.h"
#include "server/shading/bsdf.h"
#include "server/shading/bsdf_batch.h"
#include "server/shading/surface_batch.h"

namespace macula::shading {

struct ReflectorBatch {
  sampling::Vec3Batch shading, geometric, to_eye;  ///< the frame of each
  sampling::Vec3Batch diffuse, f0, reflectance;
  sampling::FloatBatch f90, cos_v;
  sampling::FloatBatch alpha;       ///< 0: without a lobe
  LobeModel lobe = LobeModel::Ggx;  ///< of all that have one

  /// Takes the first `count` of `from` over as entries from `first` on.
  void copy(std::size_t first, const ReflectorBatch& from, std::size_t count) {
    shading.copy(first, from.shading, count), geometric.copy(first, from.geometric, count);
    to_eye.copy(first, from.to_eye, count), diffuse.copy(first, from.diffuse, count);
    f0.copy(first, from.f0, count), reflectance.copy(first, from.reflectance, count);
    f90.copy(first, from.f90, count), cos_v.copy(first, from.cos_v, count);
    alpha.copy(first, from.alpha, count);
    lobe = from.lobe;
  }
  /// Takes one of `from` over as entry i.
  void take(std::size_t i, const ReflectorBatch& from, std::size_t one) {
    shading.set(i, from.shading[one]), geometric.set(i, from.geometric[one]);
    to_eye.set(i, from.to_eye[one]), diffuse.set(i, from.diffuse[one]);
    f0.set(i, from.f0[one]), reflectance.set(i, from.reflectance[one]);
    f90.at[i] = from.f90.at[one], cos_v.at[i] = from.cos_v.at[one];
    alpha.at[i] = from.alpha.at[one];
    lobe = from.lobe;
  }
  void set(std::size_t i, const Reflector& reflector) {
    shading.set(i, reflector.frame_.shading);
    geometric.set(i, reflector.frame_.geometric);
    to_eye.set(i, reflector.frame_.to_eye);
    diffuse.set(i, reflector.diffuse_);
    reflectance.set(i, reflector.reflectance_);
    f0.set(i, reflector.bsdf_.f0);
    f90.at[i] = reflector.bsdf_.f90;
    cos_v.at[i] = reflector.cos_v_;
    alpha.at[i] = reflector.glossy_ ? reflector.bsdf_.alpha : 0.0F;
    if (reflector.glossy_) lobe = reflector.bsdf_.lobe;
  }
};

/// Reflectors of the first `count` points, without directions to draw; `to_eye`: unit, world.
void make_reflectors(const BsdfBatch& bsdfs, const SurfaceBatch& surfaces,
                     const sampling::Vec3Batch& to_eye, std::size_t count, ReflectorBatch& out);

/// reflected[i] = Reflector::evaluate(to_light[i]) * irradiance[i], 0 where either is, for the
/// first `count` reflectors.
void reflect(const ReflectorBatch& reflectors, const sampling::Vec3Batch& to_light,
             const sampling::Vec3Batch& irradiance, std::size_t count,
             sampling::Vec3Batch& reflected);

}  // namespace macula::shading
