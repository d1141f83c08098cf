// Where the mesh must not stretch: between a silhouette and what it hides. Internal to this room
// and its twin, display/gl. Two neighbouring cells hang together if the camera's offset moves them
// apart by less than cut_px, or if they lie on one plane (or on two planes that meet between them),
// where stretching is what the surface really does. 1/z is affine on planes in screen space, so its
// second differences tell; no ids.
#pragma once

#include "client/reprojection/mesh.h"

namespace macula::reprojection {

class Cuts {
 public:
  Cuts(const MeshProjector& mesh, const RelativeView& relative, const foveation::Display& display,
       float cut_px);
  /// Difference of inverse depth (1/m) below which nothing needs cutting; infinite without offset.
  float harmless_difference() const { return harmless_; }
  /// Difference of inverse depth (1/m) that moves by `px` display pixels; infinite without offset.
  float difference_of(float px) const { return static_cast<float>(px / parallax_px_m_); }
  /// Whether vertices (column, row) and (column + 1, row) hang together; down: and (column, row +
  /// 1).
  bool joined_right(int column, int row) const;
  bool joined_down(int column, int row) const;

 private:
  const MeshProjector& mesh_;
  double parallax_px_m_;  ///< display pixels per difference of inverse depth
  float harmless_;
};

/// Looks at the quad whose top-left vertex is (column, row); false where its corners hang together,
/// and nothing is drawn. Otherwise, under Splat: each corner keeps its quarter up to the quad's
/// middle, at its own depth and colour, blended with the corners it is joined to. So a silhouette
/// ends where its outermost cells end, half a cell beyond their centres.
bool draw_cut_quad(const MeshProjector& mesh, const Cuts& cuts, int column, int row,
                   WarpOptions::Silhouettes silhouettes, Fragments& out);

}  // namespace macula::reprojection
