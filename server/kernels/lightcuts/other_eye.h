// OtherEye: light that one view of a frame has found, for points of another view of the same frame
// that it sees too. Found by looking from the point back into that view, so that there is nothing
// to fill: where it shows another surface, where the light may look different from here, and where
// its cells are wider, there is no light to take. Biased: by what light changes within a cell, and
// by up to kMostChange for lobes. World, meters. Immutable; safe from any thread.
// Source: Shi et al., "Foveated Stochastic Lightcuts", Algorithm 1 (the second eye).
#pragma once

#include <optional>

#include "server/kernels/kernel.h"
#include "server/kernels/lightcuts/surfaces.h"
#include "server/reconstruction/cell_areas.h"
#include "server/reconstruction/row_warp.h"

namespace macula::kernels::lightcuts {

using image::Plane;

class OtherEye {
 public:
  /// Largest share by which a lobe's light at its brightest may differ between the eyes.
  static constexpr float kMostChange = 0.05F;

  /// `light` that reaches `lit`, without what surfaces emit; refers to it and to `surfaces`.
  OtherEye(const View& lit, const ViewSurfaces& surfaces, const Plane<Rgb>& light,
           const View& view);

  /// What the tile's point i, of `view`, reflects to its eye; none: it has to be lit.
  std::optional<Rgb> light(const SurfaceTile& tile, std::size_t i) const;

 private:
  bool shows_same(const SurfaceAt& there, const ray::LitPoints& points, std::size_t i) const;
  /// Its lobe's light at its brightest differs by no more than kMostChange.
  bool looks_alike(const ray::LitPoints& points, std::size_t i) const;

  const ViewSurfaces& surfaces_;
  const Plane<Rgb>& light_;
  Vec3 lit_eye_, eye_, ahead_;
  reconstruction::RowWarp warp_;
  reconstruction::CellAreas areas_there_, areas_;
};

}  // namespace macula::kernels::lightcuts
