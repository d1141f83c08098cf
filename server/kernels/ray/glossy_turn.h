// GlossyTurn: how far the eye has moved around remembered glossy points since they were sampled,
// in widths of their lobes: what they reflect has changed by then (paper, outlook: strongly
// view-dependent shading is resampled). Pure.
#pragma once

#include <cstdint>
#include <vector>

#include "server/kernels/ray/cache.h"
#include "server/kernels/ray/config.h"
#include "server/kernels/ray/support.h"

namespace macula::kernels::ray {

/// Lobe widths of a scene's surfaces.
class GlossyTurn {
 public:
  /// Refers to the scene. In scenes of triangles; without a lobe anywhere it answers 0 for every
  /// cell.
  GlossyTurn(const SceneFrame& scene, const Config& config);

  bool any() const { return !alpha_.empty(); }
  /// Whether the surface of this id has a lobe that turns; 0: nothing was hit.
  bool is_glossy(std::uint32_t surface_id) const {
    return surface_id != 0 && alpha_[surfaces_.material(surface_id - 1)] > 0.0F;
  }
  /// Of the point at `depth_m` along the cell's ray on the surface of this id: the angle between
  /// the directions to the eye now and at `then`, over the GGX width of its lobe. 0: diffuse.
  float turn(const View& view, const image::Pixel& cell, float depth_m, std::uint32_t surface_id,
             const DVec3& then) const;

 private:
  const shading::SurfaceTable& surfaces_;
  std::vector<float> alpha_;  ///< of materials; 0: diffuse
};

/// What has become of a view's remembered glossy points.
struct GlossyPast {
  const GlossyTurn* turns = nullptr;  ///< null: no surface is glossy
  const EyePath* eyes = nullptr;      ///< of the view; with turns
  float threshold = 0.5F;             ///< FoveatedConfig::turn_threshold

  bool any() const { return turns != nullptr; }
  /// How far the eye has turned around the fresh sample of a cell since it was last sampled, over
  /// the threshold.
  float turned(const View& view, const image::Pixel& cell, const FreshSamples& fresh,
               std::uint32_t touched) const {
    const std::size_t at = fresh.at(cell.x, cell.y);
    return turns->turn(view, cell, fresh.depth_m(at), fresh.surface_id(at), eyes->at(touched)) /
           threshold;
  }
};

}  // namespace macula::kernels::ray
