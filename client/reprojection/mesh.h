// The source grid as mesh vertices, seen from the display. Internal to this room.
// Vertex columns and rows: 0 and width + 1 lie on the grid's outer edges, i in 1..width on the
// centre of cell i - 1; so the mesh reaches as far as the outermost cells do.
#pragma once

#include <vector>

#include "client/reprojection/raster.h"
#include "client/reprojection/warp.h"

namespace macula::reprojection {

/// A usable inverse depth: finite, in [0, 1000] per m.
float sound_inverse_depth(float value);

/// How the display sees the source: a point at `inverse` depth along direction d of the source view
/// lies along rotation * d + inverse * offset_m in display space; infinity (inverse 0) needs no
/// special case.
struct RelativeView {
  DMat3 rotation{1.0};
  DVec3 offset_m{0.0};
};
RelativeView relative_view(const Pose& stage_from_source, const Pose& stage_from_display,
                           WarpOptions::Method method);

/// One row of vertices, u and v included, and their inverse depth in source space (1/m).
struct VertexRow {
  std::vector<Vertex> vertices;
  std::vector<float> inverse_depths;
};

class MeshProjector {
 public:
  MeshProjector(const SourceView& source, const RelativeView& relative,
                const foveation::Display& display);

  int columns() const { return static_cast<int>(x_tangents_.size()); }
  int rows() const { return static_cast<int>(y_tangents_.size()); }
  /// Tangents of vertex columns and rows.
  const std::vector<float>& x_tangents() const { return x_tangents_; }
  const std::vector<float>& y_tangents() const { return y_tangents_; }
  /// The cell behind a vertex index: 0 .. size - 1.
  static int cell_of(int vertex, int size) {
    return vertex < 1 ? 0 : vertex > size ? size - 1 : vertex - 1;
  }
  float inverse_depth(int column, int row) const;
  /// The vertex at a tangent of the source view, at a depth in source space.
  Vertex project(float x_tangent, float y_tangent, float inverse_depth) const;
  void project_row(int row, VertexRow& out) const;

 private:
  const SourceView& source_;
  std::vector<float> x_tangents_, y_tangents_;
  Vec3 from_x_, from_y_, from_forward_,
      offset_m_;                           ///< display direction per unit of source tangent
  Vec2 pixels_per_tangent_, first_pixel_;  ///< pixel = tangent * scale + first
};

}  // namespace macula::reprojection
