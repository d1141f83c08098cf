#include "client/reprojection/cuts.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace macula::reprojection {
namespace {

/// Inverse depth at four vertices in a line, of which the middle two are asked about, and their
/// places.
struct Line {
  std::array<float, 4> place, inverse;
};

/// The step between the middle two continues the slope before it or after it, or lies between both.
bool is_planar(const Line& line, float tolerance) {
  const float step = line.inverse[2] - line.inverse[1];
  const float width = line.place[2] - line.place[1];
  const auto continued = [&](int first) {
    const float run = line.place[first + 1] - line.place[first];
    return run > 0.0F ? (line.inverse[first + 1] - line.inverse[first]) / run * width : 0.0F;
  };
  const float before = continued(0), after = continued(2);
  return step >= std::min(before, after) - tolerance && step <= std::max(before, after) + tolerance;
}

}  // namespace

Cuts::Cuts(const MeshProjector& mesh, const RelativeView& relative,
           const foveation::Display& display, float cut_px)
    : mesh_(mesh) {
  const DVec2 pixel = display.pixel_tangent();
  const double parallax_px_m = glm::length(relative.offset_m) / std::min(pixel.x, pixel.y);
  harmless_ = static_cast<float>(cut_px / parallax_px_m);  // infinite without offset
}

bool Cuts::joined_right(int column, int row) const {
  const float a = mesh_.inverse_depth(column, row), b = mesh_.inverse_depth(column + 1, row);
  if (std::abs(a - b) < harmless_) return true;
  const int before = std::max(column - 1, 0), after = std::min(column + 2, mesh_.columns() - 1);
  const auto& x = mesh_.x_tangents();
  return is_planar({{x[before], x[column], x[column + 1], x[after]},
                    {mesh_.inverse_depth(before, row), a, b, mesh_.inverse_depth(after, row)}},
                   harmless_);
}

bool Cuts::joined_down(int column, int row) const {
  const float a = mesh_.inverse_depth(column, row), b = mesh_.inverse_depth(column, row + 1);
  if (std::abs(a - b) < harmless_) return true;
  const int before = std::max(row - 1, 0), after = std::min(row + 2, mesh_.rows() - 1);
  const auto& y = mesh_.y_tangents();
  return is_planar(
      {{y[before], y[row], y[row + 1], y[after]},
       {mesh_.inverse_depth(column, before), a, b, mesh_.inverse_depth(column, after)}},
      harmless_);
}

namespace {

/// A quad with its joints. Corner index: bit 0 = right, bit 1 = lower.
struct Quad {
  std::array<float, 4> inverse;
  std::array<bool, 2> joined_x;  ///< along the upper and the lower side
  std::array<bool, 2> joined_y;  ///< along the left and the right side

  bool joined_sideways(int corner) const { return joined_x[corner >> 1]; }
  bool joined_upright(int corner) const { return joined_y[corner & 1]; }
};

/// A set of corners, one bit each.
using Corners = unsigned;
Corners only(int corner) {
  return 1U << corner;
}

/// Everything that hangs together with `corner` inside the quad.
Corners component(const Quad& quad, int corner) {
  Corners members = only(corner);
  for (int round = 0; round < 3; ++round) {  // the longest way around has three joints
    for (int i = 0; i < 4; ++i) {
      if ((members & only(i)) == 0) continue;
      if (quad.joined_sideways(i)) members |= only(i ^ 1);
      if (quad.joined_upright(i)) members |= only(i ^ 2);
    }
  }
  return members;
}

/// Inverse depth and place in the quad, (0, 0) to (1, 1), where a colour is taken: the mean of
/// corners.
struct Blend {
  float inverse = 0.0F, u = 0.0F, v = 0.0F;
};
Blend mean_of(const Quad& quad, Corners members) {
  Blend sum;
  float count = 0.0F;
  for (int corner = 0; corner < 4; ++corner) {
    if ((members & only(corner)) == 0) continue;
    sum.inverse += quad.inverse[corner];
    sum.u += static_cast<float>(corner & 1);
    sum.v += static_cast<float>(corner >> 1);
    count += 1.0F;
  }
  return {sum.inverse / count, sum.u / count, sum.v / count};
}

Quad joints_of(const MeshProjector& mesh, const Cuts& cuts, int column, int row) {
  return {{mesh.inverse_depth(column, row), mesh.inverse_depth(column + 1, row),
           mesh.inverse_depth(column, row + 1), mesh.inverse_depth(column + 1, row + 1)},
          {cuts.joined_right(column, row), cuts.joined_right(column, row + 1)},
          {cuts.joined_down(column, row), cuts.joined_down(column + 1, row)}};
}

}  // namespace

void draw_cut_quad(const MeshProjector& mesh, const Cuts& cuts, int column, int row,
                   Fragments& out) {
  const Quad quad = joints_of(mesh, cuts, column, row);
  const auto vertex = [&](float x, float y, const Blend& blend) {
    const auto &xs = mesh.x_tangents(), &ys = mesh.y_tangents();
    Vertex made = mesh.project(xs[column] + x * (xs[column + 1] - xs[column]),
                               ys[row] + y * (ys[row + 1] - ys[row]), blend.inverse);
    made.u = static_cast<float>(column - 1) + blend.u;
    made.v = static_cast<float>(row - 1) + blend.v;
    return made;
  };
  for (int corner = 0; corner < 4; ++corner) {
    const Corners self = only(corner);
    const Corners sideways = quad.joined_sideways(corner) ? self | only(corner ^ 1) : self;
    const Corners upright = quad.joined_upright(corner) ? self | only(corner ^ 2) : self;
    const float x = static_cast<float>(corner & 1), y = static_cast<float>(corner >> 1);
    // By their place in the quarter as seen from the corner: bit 0 at the middle in x, bit 1 in y.
    const std::array<Vertex, 4> quarter{vertex(x, y, mean_of(quad, self)),
                                        vertex(0.5F, y, mean_of(quad, sideways)),
                                        vertex(x, 0.5F, mean_of(quad, upright)),
                                        vertex(0.5F, 0.5F, mean_of(quad, component(quad, corner)))};
    // ... and from the upper left, whichever corner it is.
    draw_quad(quarter[corner], quarter[corner ^ 1], quarter[corner ^ 2], quarter[corner ^ 3], out);
  }
}

}  // namespace macula::reprojection
