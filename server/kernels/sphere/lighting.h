// Lighting of what a distance field's rays have met: materials with their patterns, point lights
// and suns, the sky. Without the options everything sees every light and the whole sky, as in the
// paper's own experiments; with them occlusion is traced through the field. A point's radiance
// depends on that point alone, never on its neighbours in the batch.
#pragma once

#include <optional>
#include <vector>

#include "server/kernels/sphere/config.h"
#include "server/kernels/sphere/lighting_simd.h"
#include "server/kernels/sphere/occlusion.h"

namespace macula::kernels::sphere {

class Lighting {
 public:
  /// Refers to the scene, which must outlive it. `eye`: world position of the view.
  Lighting(const SceneFrame& scene, const Config& config, const DVec3& eye);

  /// Base colours and radiance of the points, emission included. `occlusion` is of a program at the
  /// same eye.
  void light(const SurfaceBatch& points, Occlusion& occlusion, LitBatch& lit) const;

 private:
  /// A material ready to be shown. Glossy: some of its points have a lobe.
  struct Row {
    MatteRow matte;
    std::optional<scene::Pattern> pattern;
    bool glossy = false;
  };
  Row row_of(const scene::Material& material, scene::Index index) const;
  void set_reflectors(const SurfaceBatch& points, LitBatch& lit) const;
  void set_lobes(const SurfaceBatch& points, LitBatch& lit) const;
  void add_light(const scene::Light& light, const SurfaceBatch& points, Occlusion& occlusion,
                 LitBatch& lit) const;
  void add_sky(const SurfaceBatch& points, Occlusion& occlusion, LitBatch& lit) const;
  void traced_sky(const SurfaceBatch& points, const shading::ReflectorBatch& reflectors,
                  Occlusion& occlusion, sampling::FloatBatch& reaching) const;

  const SceneFrame& scene_;
  const Config& config_;
  Vec3 eye_;
  std::vector<scene::Light> lights_;  ///< relative to the eye
  std::vector<Row> rows_;             ///< by material
};

}  // namespace macula::kernels::sphere
