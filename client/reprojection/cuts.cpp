#include "client/reprojection/cuts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

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
    : mesh_(mesh),
      parallax_px_m_(glm::length(relative.offset_m) /
                     std::min(display.pixel_tangent().x, display.pixel_tangent().y)),
      harmless_(difference_of(cut_px)) {}

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
  bool is_whole() const { return joined_x[0] && joined_x[1] && joined_y[0] && joined_y[1]; }
};

/// A set of corners, one bit each.
using Corners = unsigned;
Corners only(int corner) {
  return 1U << corner;
}

/// Everything that hangs together with a corner, by the joints of its quad: bits 0 and 1 along the
/// upper and the lower side, 2 and 3 along the left and the right.
using Components = std::array<std::array<std::uint8_t, 4>, 16>;
constexpr Components find_components() {
  Components all{};
  for (unsigned joints = 0; joints < 16; ++joints) {
    for (unsigned corner = 0; corner < 4; ++corner) {
      unsigned members = 1U << corner;
      for (int round = 0; round < 3; ++round) {  // the longest way around has three joints
        for (unsigned i = 0; i < 4; ++i) {
          if ((members >> i & 1U) == 0) continue;
          if ((joints >> (i >> 1) & 1U) != 0) members |= 1U << (i ^ 1U);
          if ((joints >> (2 + (i & 1U)) & 1U) != 0) members |= 1U << (i ^ 2U);
        }
      }
      all[joints][corner] = static_cast<std::uint8_t>(members);
    }
  }
  return all;
}
constexpr Components kComponents = find_components();

Corners component(const Quad& quad, int corner) {
  const unsigned joints = (quad.joined_x[0] ? 1U : 0U) | (quad.joined_x[1] ? 2U : 0U) |
                          (quad.joined_y[0] ? 4U : 0U) | (quad.joined_y[1] ? 8U : 0U);
  return kComponents[joints][static_cast<std::size_t>(corner)];
}

/// Inverse depth and place in the quad, (0, 0) to (1, 1), where a colour is taken: the mean of
/// corners.
struct Blend {
  float inverse = 0.0F, u = 0.0F, v = 0.0F;
};
Blend mean_of(const Quad& quad, Corners members) {
  const auto in = [&](int corner) { return static_cast<float>(members >> corner & 1U); };
  const float a = in(0), b = in(1), c = in(2), d = in(3);
  const float per_count = 1.0F / (a + b + c + d);
  const auto& z = quad.inverse;
  return {(a * z[0] + b * z[1] + c * z[2] + d * z[3]) * per_count, (b + d) * per_count,
          (c + d) * per_count};
}

Quad joints_of(const MeshProjector& mesh, const Cuts& cuts, int column, int row) {
  return {{mesh.inverse_depth(column, row), mesh.inverse_depth(column + 1, row),
           mesh.inverse_depth(column, row + 1), mesh.inverse_depth(column + 1, row + 1)},
          {cuts.joined_right(column, row), cuts.joined_right(column, row + 1)},
          {cuts.joined_down(column, row), cuts.joined_down(column + 1, row)}};
}

}  // namespace

bool draw_cut_quad(const MeshProjector& mesh, const Cuts& cuts, int column, int row,
                   WarpOptions::Silhouettes silhouettes, Fragments& out) {
  const Quad quad = joints_of(mesh, cuts, column, row);
  if (quad.is_whole()) return false;
  if (silhouettes != WarpOptions::Silhouettes::Splat) return true;
  const auto &xs = mesh.x_tangents(), &ys = mesh.y_tangents();
  const float width = xs[column + 1] - xs[column], height = ys[row + 1] - ys[row];
  // Vertex 4 * corner + place in its quarter as seen from the corner: bit 0 at the quad's middle in
  // x, bit 1 in y.
  std::array<Blend, Points::kCount> blends;
  Points points;
  for (int corner = 0; corner < 4; ++corner) {
    const Corners self = only(corner);
    const Corners sideways = quad.joined_sideways(corner) ? self | only(corner ^ 1) : self;
    const Corners upright = quad.joined_upright(corner) ? self | only(corner ^ 2) : self;
    const std::array<Corners, 4> colored{self, sideways, upright, component(quad, corner)};
    for (int place = 0; place < 4; ++place) {
      const int i = 4 * corner + place;
      const float x = (place & 1) != 0 ? 0.5F : static_cast<float>(corner & 1);
      const float y = (place & 2) != 0 ? 0.5F : static_cast<float>(corner >> 1);
      blends[i] = mean_of(quad, colored[place]);
      points.x_tangent[i] = xs[column] + x * width;
      points.y_tangent[i] = ys[row] + y * height;
      points.source_inverse[i] = blends[i].inverse;
    }
  }
  project_points(mesh.projection(), points);
  const auto vertex = [&](int i) {
    return Vertex{points.x[i], points.y[i], points.inverse_depth[i],
                  static_cast<float>(column - 1) + blends[i].u,
                  static_cast<float>(mesh.layer_row() + row - 1) + blends[i].v};
  };
  for (int corner = 0; corner < 4; ++corner) {
    const int first = 4 * corner;  // from the upper left, whichever corner it is
    draw_quad(vertex(first + corner), vertex(first + (corner ^ 1)), vertex(first + (corner ^ 2)),
              vertex(first + (corner ^ 3)), out);
  }
  return true;
}

}  // namespace macula::reprojection
