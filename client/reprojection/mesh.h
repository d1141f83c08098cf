// The source grid as mesh vertices, seen from the display. Internal to this room and its twin,
// display/gl.
// Vertex columns and rows: 0 and width + 1 lie on the grid's outer edges, i in 1..width on the
// centre of cell i - 1; so the mesh reaches as far as the outermost cells do.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "client/reprojection/mesh_rules.h"
#include "client/reprojection/patch.h"
#include "client/reprojection/raster.h"
#include "client/reprojection/warp.h"

namespace macula::reprojection {

/// A usable inverse depth: finite, in [0, 1000] per m.
inline float sound_inverse_depth(float value) {
  if (!(value > 0.0F) || std::isinf(value)) return 0.0F;  // also NaN
  return std::min(value, kNearest_per_m);
}

/// How the display sees the source: a point at `inverse` depth along direction d of the source view
/// lies along rotation * d + inverse * offset_m in display space; infinity (inverse 0) needs no
/// special case.
struct RelativeView {
  DMat3 rotation{1.0};
  DVec3 offset_m{0.0};
};
RelativeView relative_view(const Pose& stage_from_source, const Pose& stage_from_display,
                           WarpOptions::Method method);

/// What projects a vertex: a display direction per unit of source tangent, and pixels of that.
struct Projection {
  Vec3 from_x, from_y, from_forward, offset_m;
  Vec2 pixels_per_tangent, first_pixel;  ///< pixel = tangent * scale + first
};
/// Inverse depths of a patch's vertex rows, as they came: a whole patch may be read from each.
using DepthRows = std::array<const float*, Patch::kRows>;
/// Fills a patch's source_inverse.
void load_depths(const DepthRows& depths, Patch& patch);
/// Fills everything that follows from tangents and source_inverse.
void project_patch(const Projection& projection, Patch& patch);

/// Vertices of no patch, by tangent and sound inverse depth in source space.
struct Points {
  static constexpr int kCount = 16;
  alignas(64) float x_tangent[kCount], y_tangent[kCount], source_inverse[kCount];
  alignas(64) float x[kCount], y[kCount], inverse_depth[kCount];  ///< as Vertex
  alignas(64) float nearness[kCount];                             ///< as in Patch
};
/// From the first three members to the others.
void project_points(const Projection& projection, Points& points);

class MeshProjector {
 public:
  /// `layer_row`: 0, or kSecondLayerRow where `source` holds the second layer's planes.
  MeshProjector(const SourceView& source, const RelativeView& relative,
                const foveation::Display& display, int layer_row = 0);

  int columns() const { return static_cast<int>(x_tangents_.size()); }
  int rows() const { return static_cast<int>(y_tangents_.size()); }
  /// Tangents of vertex columns and rows.
  const std::vector<float>& x_tangents() const { return x_tangents_; }
  const std::vector<float>& y_tangents() const { return y_tangents_; }
  /// The cell behind a vertex index: 0 .. size - 1.
  static int cell_of(int vertex, int size) {
    return vertex < 1 ? 0 : vertex > size ? size - 1 : vertex - 1;
  }
  float inverse_depth(int column, int row) const {
    const auto& plane = source_.inverse_depth_per_m;
    return sound_inverse_depth(plane(cell_of(column, plane.width()), cell_of(row, plane.height())));
  }
  int layer_row() const { return layer_row_; }
  const Projection& projection() const { return projection_; }
  /// The vertex at a tangent of the source view, at a depth in source space. The oracle of
  /// project_patch and project_points.
  Vertex project(float x_tangent, float y_tangent, float inverse_depth) const;
  /// The mesh's cells (column, row) to (column + columns, row + rows): tangents and source depths,
  /// and only the four outermost corners projected; project_patch does the rest.
  void load(int column, int row, int columns, int rows, Patch& out) const;

 private:
  const SourceView& source_;
  const int layer_row_;
  std::vector<float> x_tangents_, y_tangents_;
  Projection projection_;
};

}  // namespace macula::reprojection
