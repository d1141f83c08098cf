// A z-buffered rasteriser that keeps, for every display pixel, where in the source grid its colour
// comes from. Pixel coordinates have their origin at the CENTRE of the top-left pixel, so that
// pixel (i, j) is sampled at exactly (i, j). Three ways to draw, by size: many cells at a time
// (draw_cells), one block of them many pixels at a time (draw_block), and one piece of a cut cell
// (draw_quad), which is also the oracle of the other two. Internal to this room; one thread.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "client/reprojection/fragments.h"
#include "client/reprojection/patch.h"

namespace macula::reprojection {

/// A vertex as the display sees it. NaN coordinates: not in front of the eye.
struct Vertex {
  float x, y;           ///< display pixels
  float inverse_depth;  ///< 1/m in display space; affine across the screen on any plane
  float u, v;           ///< cell coordinates, cell (i, j)'s centre at exactly (i, j)
};

/// Draws the triangle where it is nearer than what is there. Triangles seen from behind (clockwise
/// on the y-down screen is the front) or without area are left out, as are those with a NaN vertex.
/// Attributes are interpolated affinely on the screen: exact for inverse depth; for u and v the
/// error is a quarter of the relative change of depth across a cell, below a hundredth of a cell.
void draw_triangle(const Vertex& a, const Vertex& b, const Vertex& c, Fragments& out);

/// Two triangles that share the diagonal from upper right to lower left; nothing if the upper left
/// vertex is NaN.
void draw_quad(const Vertex& upper_left, const Vertex& upper_right, const Vertex& lower_left,
               const Vertex& lower_right, Fragments& out);

/// Cells of one row of a patch, one bit each.
using CellBits = std::uint32_t;

/// Draws the cells of `row` named by `cells` as draw_quad does. Returns those that spread over too
/// many pixels for this way; they are left for draw_block.
CellBits draw_cells(const Patch& patch, int row, CellBits cells, Fragments& out);

/// A rectangle of a patch's cells, by its upper left vertex.
struct Block {
  int column, row, columns, rows;
};

/// Cell coordinate, 0 to `count`, at a share 0 to 1 of a stretch of tangents: exact for equal steps
/// and for steps that grow evenly.
struct Stretch {
  float count = 1.0F, bend = 0.0F;
  float cell(float share) const { return count * (share + bend * share * (1.0F - share)); }
};

/// Rows of pixels that something covers, both ends included; none where first > last.
struct RowRange {
  float first, last;
};
/// A block as its corners show it; what draws it needs no patch any more.
struct BlockShape {
  struct Corner {
    float x, y, inverse_depth, nearness;
  };
  Corner upper_left, upper_right, lower_left, lower_right;
  float u, v;  ///< cell coordinates of the upper left corner
  Stretch across, down;

  RowRange pixel_rows() const {
    const auto [first, last] =
        std::minmax({upper_left.y, upper_right.y, lower_left.y, lower_right.y});
    return {first, last};
  }
};
/// Of a block's columns and of its rows.
Stretch column_stretch(const Patch& patch, const Block& block);
Stretch row_stretch(const Patch& patch, const Block& block);
BlockShape shape_of(const Patch& patch, const Block& block);

/// Draws the block by its four corners alone, u and v by true perspective, grown by `grow_px`
/// against cracks beside neighbours that were drawn finer.
void draw_block(const BlockShape& shape, float grow_px, Fragments& out);

/// Cells of `row` whose corners' inverse depths, in source space, differ by `step` (1/m) or more.
CellBits cells_with_steps(const Patch& patch, int row, float step);

/// Whether every vertex of the block lies within `tolerance` (1/m) of the two triangles that its
/// corners span in inverse depth, and no corner is behind the eye.
bool is_flat(const Patch& patch, const Block& block, float tolerance);

/// By vertex row of a patch: of all its vertices in front of the eye.
using VertexRows = std::array<RowRange, Patch::kRows>;
void pixel_rows(const Patch& patch, VertexRows& rows);

}  // namespace macula::reprojection
