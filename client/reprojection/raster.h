// A z-buffered triangle rasteriser that keeps, for every display pixel, where in the source grid
// its colour comes from. Pixel coordinates have their origin at the CENTRE of the top-left pixel,
// so that pixel (i, j) is sampled at exactly (i, j). Internal to this room; one thread.
#pragma once

#include <vector>

#include "shared/image/plane.h"

namespace macula::reprojection {

/// A vertex as the display sees it. NaN coordinates: not in front of the eye.
struct Vertex {
  float x, y;           ///< display pixels
  float inverse_depth;  ///< 1/m in display space; affine across the screen on any plane
  float u, v;           ///< cell coordinates, cell (i, j)'s centre at exactly (i, j)
};

struct Fragment {
  float inverse_depth = -1.0F;  ///< -1: nothing drawn yet; infinity itself is 0
  float u = 0.0F, v = 0.0F;
  bool drawn() const { return inverse_depth >= 0.0F; }
};
using Fragments = image::Plane<Fragment>;

/// Draws the triangle where it is nearer than what is there. Triangles seen from behind (clockwise
/// on the y-down screen is the front) or without area are left out, as are those with a NaN vertex.
/// Attributes are interpolated affinely on the screen: exact for inverse depth; for u and v the
/// error is a quarter of the relative change of depth across a cell, below a hundredth of a cell.
void draw_triangle(const Vertex& a, const Vertex& b, const Vertex& c, Fragments& out);

/// Two triangles that share the diagonal from upper right to lower left; nothing if the upper left
/// vertex is NaN.
void draw_quad(const Vertex& upper_left, const Vertex& upper_right, const Vertex& lower_left,
               const Vertex& lower_right, Fragments& out);

}  // namespace macula::reprojection
