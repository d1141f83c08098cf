#include "client/reprojection/mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/reprojection/mesh_rules.h"

namespace macula::reprojection {
namespace {

constexpr int kVector = 16;  ///< floats of the widest

/// Edge, centres, edge.
std::vector<float> vertex_tangents(const std::vector<float>& edges) {
  std::vector<float> tangents;
  tangents.reserve(edges.size() + 1);
  tangents.push_back(edges.front());
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    tangents.push_back(edges[i] + 0.5F * (edges[i + 1] - edges[i]));  // as PixelGrid::tangent
  }
  tangents.push_back(edges.back());
  return tangents;
}

void copy_tangents(const std::vector<float>& from, int begin, int cells,
                   std::array<float, Patch::kStride>& to) {
  const auto end = std::copy_n(from.begin() + begin, cells + 1, to.begin());
  std::fill(end, to.end(), std::numeric_limits<float>::infinity());
}

void project_corners(const Projection& projection, Patch& patch) {
  Points points{};
  for (int i = 0; i < 4; ++i) {
    const int column = (i & 1) * patch.columns, row = (i >> 1) * patch.rows;
    points.x_tangent[i] = patch.x_tangents[column], points.y_tangent[i] = patch.y_tangents[row];
    points.source_inverse[i] = patch.source_inverse[Patch::at(column, row)];
  }
  project_points(projection, points);
  for (int i = 0; i < 4; ++i) {
    const std::size_t at = Patch::at((i & 1) * patch.columns, (i >> 1) * patch.rows);
    patch.x[at] = points.x[i], patch.y[at] = points.y[i];
    patch.inverse_depth[at] = points.inverse_depth[i], patch.nearness[at] = points.nearness[i];
  }
}

}  // namespace

RelativeView relative_view(const Pose& stage_from_source, const Pose& stage_from_display,
                           WarpOptions::Method method) {
  if (method == WarpOptions::Method::Stale) return {};
  const Pose display_from_source = inverse(stage_from_display) * stage_from_source;
  const DMat3 rotation = glm::mat3_cast(display_from_source.rotation);
  if (method == WarpOptions::Method::RotationOnly) return {rotation, DVec3{0.0}};
  return {rotation, display_from_source.position};
}

MeshProjector::MeshProjector(const SourceView& source, const RelativeView& relative,
                             const foveation::Display& display, int layer_row)
    : source_(source),
      layer_row_(layer_row),
      x_tangents_(vertex_tangents(source.grid.x_edges)),
      y_tangents_(vertex_tangents(source.grid.y_edges)) {
  projection_.from_x = Vec3(relative.rotation[0]);
  projection_.from_y = Vec3(-relative.rotation[1]);  // tangents grow downwards
  projection_.from_forward = Vec3(-relative.rotation[2]);
  projection_.offset_m = Vec3(relative.offset_m);
  const DVec2 scale = 1.0 / display.pixel_tangent();
  projection_.pixels_per_tangent = Vec2(scale);
  projection_.first_pixel = Vec2(-display.fov.tangent_min() * scale - 0.5);
}

Vertex MeshProjector::project(float x_tangent, float y_tangent, float inverse_depth) const {
  const Projection& p = projection_;
  const Vec3 direction =
      p.from_forward + y_tangent * p.from_y + x_tangent * p.from_x + inverse_depth * p.offset_m;
  const float forward = -direction.z;  // display depth over source depth
  if (!(forward > kLeastForward && forward > kNear_m * inverse_depth)) {
    constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();
    return {kNowhere, kNowhere, 0.0F, 0.0F, 0.0F};
  }
  const float scale = 1.0F / forward;
  return {direction.x * scale * p.pixels_per_tangent.x + p.first_pixel.x,
          -direction.y * scale * p.pixels_per_tangent.y + p.first_pixel.y, inverse_depth * scale,
          0.0F, 0.0F};
}

void MeshProjector::load(int column, int row, int columns, int rows, Patch& out) const {
  out.column = column, out.row = row, out.columns = columns, out.rows = rows;
  out.layer_row = layer_row_;
  copy_tangents(x_tangents_, column, columns, out.x_tangents);
  copy_tangents(y_tangents_, row, rows, out.y_tangents);
  const auto& plane = source_.inverse_depth_per_m;
  DepthRows depths{};
  const bool inside = column >= 1 && column - 1 + Patch::kRows + kVector <= plane.width();
  for (int j = 0; j <= rows; ++j) {
    const auto from = plane.row(cell_of(row + j, plane.height()));
    if (inside) {
      depths[j] = from.data() + (column - 1);
      continue;
    }
    float* const to = out.source_inverse.data() + Patch::at(0, j);
    for (int i = 0; i <= columns; ++i) to[i] = from[cell_of(column + i, plane.width())];
    depths[j] = to;
  }
  load_depths(depths, out);
  project_corners(projection_, out);
}

}  // namespace macula::reprojection
