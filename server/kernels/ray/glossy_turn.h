// GlossyTurn: how far the eye has moved around remembered glossy points since they were sampled,
// in widths of their lobes: what they reflect has changed by then (paper, outlook: strongly
// view-dependent shading is resampled). Pure.
#pragma once

#include <algorithm>
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
  /// the directions to the eye now and where it was before it came `way` (meters, view space), over
  /// the GGX width of its lobe. 0: diffuse.
  float turn(const View& view, const image::Pixel& cell, float depth_m, std::uint32_t surface_id,
             const Vec3& way) const;

 private:
  const shading::SurfaceTable& surfaces_;
  std::vector<float> alpha_;  ///< of materials; 0: diffuse
};

/// What has become of a view's remembered glossy points.
struct GlossyPast {
  const GlossyTurn* turns = nullptr;  ///< null: no surface is glossy
  std::vector<Vec3> ways{};           ///< EyePath::ways(); with turns
  std::uint32_t clock = 0;            ///< EyePath::newest()
  float threshold = 0.5F;             ///< FoveatedConfig::turn_threshold

  bool any() const { return turns != nullptr; }
  /// Whether `a` is longer ago than `b`; neither is later than the clock.
  bool is_older(std::uint32_t a, std::uint32_t b) const { return clock - a > clock - b; }
  /// How far the eye has turned around the fresh sample of a cell since it was last sampled, over
  /// the threshold.
  float turned(const View& view, const image::Pixel& cell, const FreshSamples& fresh,
               std::uint32_t touched) const {
    const std::size_t at = fresh.at(cell.x, cell.y);
    const std::size_t age = std::min<std::size_t>(clock - touched, ways.size() - 1);
    return turns->turn(view, cell, fresh.depth_m(at), fresh.surface_id(at), ways[age]) / threshold;
  }
};

}  // namespace macula::kernels::ray
