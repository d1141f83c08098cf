#include "client/reprojection/mesh.h"

#include <cmath>
#include <limits>

namespace macula::reprojection {
namespace {

constexpr float kNear_m = 0.01F;
/// Least cosine-like component towards the view axis: directions beyond 89.9 degrees have no pixel.
constexpr float kLeastForward = 1e-3F;

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

}  // namespace

float sound_inverse_depth(float value) {
  constexpr float kNearest_per_m = 1000.0F;
  if (!(value > 0.0F) || std::isinf(value)) return 0.0F;  // also NaN
  return std::min(value, kNearest_per_m);
}

RelativeView relative_view(const Pose& stage_from_source, const Pose& stage_from_display,
                           WarpOptions::Method method) {
  if (method == WarpOptions::Method::Stale) return {};
  const Pose display_from_source = inverse(stage_from_display) * stage_from_source;
  const DMat3 rotation = glm::mat3_cast(display_from_source.rotation);
  if (method == WarpOptions::Method::RotationOnly) return {rotation, DVec3{0.0}};
  return {rotation, display_from_source.position};
}

MeshProjector::MeshProjector(const SourceView& source, const RelativeView& relative,
                             const foveation::Display& display)
    : source_(source),
      x_tangents_(vertex_tangents(source.grid.x_edges)),
      y_tangents_(vertex_tangents(source.grid.y_edges)),
      from_x_(relative.rotation[0]),
      from_y_(-relative.rotation[1]),  // tangents grow downwards
      from_forward_(-relative.rotation[2]),
      offset_m_(relative.offset_m) {
  const DVec2 scale = 1.0 / display.pixel_tangent();
  pixels_per_tangent_ = Vec2(scale);
  first_pixel_ = Vec2(-display.fov.tangent_min() * scale - 0.5);
}

float MeshProjector::inverse_depth(int column, int row) const {
  const auto& plane = source_.inverse_depth_per_m;
  return sound_inverse_depth(plane(cell_of(column, plane.width()), cell_of(row, plane.height())));
}

Vertex MeshProjector::project(float x_tangent, float y_tangent, float inverse_depth) const {
  const Vec3 direction =
      from_forward_ + y_tangent * from_y_ + x_tangent * from_x_ + inverse_depth * offset_m_;
  const float forward = -direction.z;  // display depth over source depth
  if (!(forward > kLeastForward && forward > kNear_m * inverse_depth)) {
    constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();
    return {kNowhere, kNowhere, 0.0F, 0.0F, 0.0F};
  }
  const float scale = 1.0F / forward;
  return {direction.x * scale * pixels_per_tangent_.x + first_pixel_.x,
          -direction.y * scale * pixels_per_tangent_.y + first_pixel_.y, inverse_depth * scale,
          0.0F, 0.0F};
}

void MeshProjector::project_row(int row, VertexRow& out) const {
  const auto& plane = source_.inverse_depth_per_m;
  const auto depths = plane.row(cell_of(row, plane.height()));
  out.vertices.resize(x_tangents_.size());
  out.inverse_depths.resize(x_tangents_.size());
  for (int i = 0; i < columns(); ++i) {
    const float inverse_depth = sound_inverse_depth(depths[cell_of(i, plane.width())]);
    out.inverse_depths[i] = inverse_depth;
    out.vertices[i] = project(x_tangents_[i], y_tangents_[row], inverse_depth);
    out.vertices[i].u = static_cast<float>(i - 1);
    out.vertices[i].v = static_cast<float>(row - 1);
  }
}

}  // namespace macula::reprojection
