// Lighting of what a distance field's rays have met: materials with their patterns, point lights
// and suns, the sky. Without the options everything sees every light and the whole sky, as in the
// paper's own experiments; with them occlusion is traced through the field. A point's radiance
// depends on that point alone, never on its neighbours in the batch.
#pragma once

#include <span>
#include <vector>

#include "server/kernels/sphere/config.h"
#include "server/kernels/sphere/occlusion.h"
#include "server/kernels/sphere/surface_batch.h"
#include "server/shading/reflector_batch.h"

namespace macula::kernels::sphere {

class Lighting {
 public:
  /// Refers to the scene, which must outlive it. `eye`: world position of the view.
  Lighting(const SceneFrame& scene, const Config& config, const DVec3& eye);

  /// What the points are made of: base colour under their patterns.
  void base_colors(const SurfaceBatch& points, std::span<Rgb> out) const;
  /// Radiance towards the eye, emission included. radiance.size() == base_colors.size() ==
  /// points.count. `occlusion` is of a program at the same eye.
  void radiance(const SurfaceBatch& points, std::span<const Rgb> base_colors, Occlusion& occlusion,
                std::span<Rgb> radiance) const;

 private:
  void set_reflectors(const SurfaceBatch& points, std::span<const Rgb> base_colors,
                      shading::ReflectorBatch& reflectors) const;
  void add_light(const scene::Light& light, const SurfaceBatch& points,
                 const shading::ReflectorBatch& reflectors, Occlusion& occlusion,
                 std::span<Rgb> radiance) const;
  void add_sky(const SurfaceBatch& points, const shading::ReflectorBatch& reflectors,
               Occlusion& occlusion, std::span<Rgb> radiance) const;
  void traced_sky(const SurfaceBatch& points, const shading::ReflectorBatch& reflectors,
                  Occlusion& occlusion, sampling::FloatBatch& reaching) const;

  const SceneFrame& scene_;
  const Config& config_;
  Vec3 eye_;
  std::vector<scene::Light> lights_;  ///< relative to the eye
};

}  // namespace macula::kernels::sphere
