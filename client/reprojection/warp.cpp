#include "client/reprojection/warp.h"

#include <algorithm>

#include "client/reprojection/cuts.h"
#include "client/reprojection/holes.h"
#include "client/reprojection/resolve.h"

namespace macula::reprojection {
namespace {

/// Largest difference of inverse depth between the corners of a quad, in source space.
float spread(const VertexRow& upper, const VertexRow& lower, int column) {
  const float a = upper.inverse_depths[column], b = upper.inverse_depths[column + 1];
  const float c = lower.inverse_depths[column], d = lower.inverse_depths[column + 1];
  return std::max(std::max(a, b), std::max(c, d)) - std::min(std::min(a, b), std::min(c, d));
}

void draw_mesh(const MeshProjector& mesh, const Cuts& cuts, Fragments& out) {
  VertexRow upper, lower;
  mesh.project_row(0, upper);
  for (int row = 0; row + 1 < mesh.rows(); ++row) {
    mesh.project_row(row + 1, lower);
    const Vertex *above = upper.vertices.data(), *below = lower.vertices.data();
    for (int column = 0; column + 1 < mesh.columns(); ++column) {
      if (spread(upper, lower, column) >= cuts.harmless_difference()) {
        draw_cut_quad(mesh, cuts, column, row, out);
      } else {
        draw_quad(above[column], above[column + 1], below[column], below[column + 1], out);
      }
    }
    std::swap(upper, lower);
  }
}

WarpReport count(const image::Plane<Coverage>& coverage) {
  WarpReport report;
  for (const Coverage c : coverage.pixels()) {
    report.covered_px += c == Coverage::Covered ? 1 : 0;
    report.filled_px += c == Coverage::Filled ? 1 : 0;
    report.outside_px += c == Coverage::Outside ? 1 : 0;
  }
  return report;
}

void check_sizes(const SourceView& source, const foveation::Display& display) {
  const auto fits = [&](const auto& plane) {
    return plane.width() == source.grid.width() && plane.height() == source.grid.height();
  };
  MACULA_CHECK(foveation::is_valid(source.grid));
  MACULA_CHECK(fits(source.color) && fits(source.inverse_depth_per_m),
               "colour and depth must have the size of the grid");
  MACULA_CHECK(display.width_px > 0 && display.height_px > 0 && math::is_valid(display.fov));
}

}  // namespace

WarpReport warp(const SourceView& source, const Pose& stage_from_display,
                const foveation::Display& display, const WarpOptions& options,
                image::Plane<Rgb8>& out, image::Plane<Coverage>* coverage) {
  check_sizes(source, display);
  const RelativeView relative =
      relative_view(source.stage_from_view, stage_from_display, options.method);
  const MeshProjector mesh(source, relative, display);
  const Cuts cuts(mesh, relative, display, options.cut_px);

  Fragments fragments(display.width_px, display.height_px);
  draw_mesh(mesh, cuts, fragments);

  image::Plane<Coverage> own;
  image::Plane<Coverage>& marks = coverage != nullptr ? *coverage : own;
  classify_and_fill(fragments, options.holes, marks);
  resolve_colors(fragments, source.color, options.filter, out);
  return count(marks);
}

}  // namespace macula::reprojection
