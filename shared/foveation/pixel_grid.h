// PixelGrid: where a picture is sampled. Strictly increasing tables of cell edges on the view's
// tangent plane (frames.h: x right, y down). Equal steps make an ordinary picture; a foveal grid
// has steps of one nominal display pixel (or a fraction of it) around the gaze and wider ones
// outside. Guard bands and oversampled foveas are grids, not special cases. A cell's identity is
// its rectangle, so the same rectangle in two grids gets the same samples.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "shared/base/result.h"
#include "shared/foveation/gaze.h"
#include "shared/foveation/rate.h"
#include "shared/math/fov.h"
#include "shared/math/frames.h"

namespace macula::foveation {

/// The display a picture is for: its pixels are the nominal ones that rates refer to.
struct Display {
  Fov fov;
  int width_px = 0;
  int height_px = 0;

  /// Size of one nominal pixel on the tangent plane.
  DVec2 pixel_tangent() const;
  /// Pixels per degree at the point of the tangent plane that faces the viewer.
  double pixels_per_degree() const;
};

struct PixelGrid {
  std::vector<float> x_edges;  ///< width() + 1 tangents, strictly increasing
  std::vector<float> y_edges;  ///< height() + 1 tangents, strictly increasing downwards

  int width() const { return static_cast<int>(x_edges.size()) - 1; }
  int height() const { return static_cast<int>(y_edges.size()) - 1; }
  /// Tangent of the point (fx, fy) in [0,1]^2 of a cell; (0.5, 0.5) is its centre.
  Vec2 tangent(int x, int y, float fx = 0.5F, float fy = 0.5F) const {
    return {x_edges[x] + fx * (x_edges[x + 1] - x_edges[x]),
            y_edges[y] + fy * (y_edges[y + 1] - y_edges[y])};
  }
  /// View-space direction through a cell, z = -1, not normalised.
  Vec3 ray(int x, int y, float fx = 0.5F, float fy = 0.5F) const {
    return math::direction_from_tangent(tangent(x, y, fx, fy));
  }
  /// Width and height of a cell on the tangent plane.
  Vec2 footprint(int x, int y) const {
    return {x_edges[x + 1] - x_edges[x], y_edges[y + 1] - y_edges[y]};
  }
  /// Continuous cell coordinates (cell i's centre is i + 0.5) of a tangent; nullopt outside the
  /// grid.
  std::optional<Vec2> locate(const Vec2& tangent) const;
  /// The same for a view-space point; nullopt behind the eye or outside the grid.
  std::optional<Vec2> project(const Vec3& view_point) const;
  /// Hash of the cell's rectangle: the `cell` that samples are a function of.
  std::uint64_t cell_key(int x, int y) const;
  friend bool operator==(const PixelGrid&, const PixelGrid&) = default;
};

/// Strictly increasing, finite, 1..16384 cells a side, tangents within +-1e3.
bool is_valid(const PixelGrid& grid);

/// Equal steps of one display pixel: width_px x height_px cells.
PixelGrid make_uniform_grid(const Display& display);

struct FovealGridOptions {
  /// Cells per nominal pixel along an axis at the gaze: 1, 2, 3, ... or 1.5.
  double fovea_oversampling = 1.0;
  /// Disc around the gaze that keeps cells of exactly that size.
  Degrees full_rate_radius{5.0};
  /// Added on every side beyond the display's field of view.
  Degrees guard_band{0.0};
};

/// Density (cells per nominal pixel of area) is never below model.rate(e) at any eccentricity, and
/// cells within full_rate_radius (and on the columns and rows through it) lie on the display's own
/// pixel raster, bit-equal to make_uniform_grid's edges at oversampling 1. Any gaze is legal.
PixelGrid make_foveal_grid(const Display& display, const Gaze& gaze, const RateModel& model,
                           const FovealGridOptions& options = {});

}  // namespace macula::foveation

namespace macula {
using foveation::PixelGrid;
}
