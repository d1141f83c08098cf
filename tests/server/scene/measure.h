// What makes a scene honest, measured: triangles that only subdivide a plane, and how many surfaces
// lie behind one another along a line of sight.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "server/scene/scene.h"

namespace macula::scene::measure {

/// Triangles of a mesh that lie in one plane with a neighbour: they share an edge (by
/// position) and their normals differ by less than half a degree.
inline std::size_t coplanar_triangles(const Mesh& mesh) {
  using Key = std::tuple<float, float, float>;
  const auto key = [&mesh](Index i) {
    return Key{mesh.positions[i].x, mesh.positions[i].y, mesh.positions[i].z};
  };
  const auto normal = [&mesh](const UVec3& t) {
    return normalize(cross(DVec3(mesh.positions[t.y] - mesh.positions[t.x]),
                           DVec3(mesh.positions[t.z] - mesh.positions[t.x])));
  };
  std::map<Key, Index> welded;
  for (Index i = 0; i < mesh.positions.size(); ++i) welded.emplace(key(i), i);
  std::map<std::pair<Index, Index>, std::vector<std::size_t>> by_edge;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      const Index a = welded[key(mesh.triangles[i][corner])],
                  b = welded[key(mesh.triangles[i][(corner + 1) % 3])];
      by_edge[std::minmax(a, b)].push_back(i);
    }
  }
  const double limit = std::cos(0.5 * std::numbers::pi / 180.0);
  std::vector<bool> coplanar(mesh.triangles.size());
  for (const auto& [edge, sharing] : by_edge) {
    if (sharing.size() != 2) continue;
    if (dot(normal(mesh.triangles[sharing[0]]), normal(mesh.triangles[sharing[1]])) < limit)
      continue;
    coplanar[sharing[0]] = coplanar[sharing[1]] = true;
  }
  return static_cast<std::size_t>(std::count(coplanar.begin(), coplanar.end(), true));
}

/// Surfaces drawn into one picture, each pixel counting what covers its centre.
class DepthCounter {
 public:
  DepthCounter(const Camera& camera, int width_px, int height_px)
      : view_from_world_(math::inverse(camera.parent_from_view)),
        pixels_per_tangent_(0.5 * height_px / std::tan(0.5 * camera.vertical_fov.value())),
        counts_(width_px, height_px, 0) {}

  void add(const DVec3& a, const DVec3& b, const DVec3& c) {
    const std::vector<DVec3> seen =
        clipped({view_from_world_.transform_point(a), view_from_world_.transform_point(b),
                 view_from_world_.transform_point(c)});
    for (std::size_t i = 2; i < seen.size(); ++i)
      fill(project(seen[0]), project(seen[i - 1]), project(seen[i]));
  }
  double mean() const {
    double sum = 0.0;
    for (const int count : counts_.pixels()) sum += count;
    return sum / static_cast<double>(counts_.size());
  }

 private:
  static double edge(const DVec2& a, const DVec2& b, const DVec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  }
  /// The part of a triangle at least 5 cm in front of the eye (Sutherland-Hodgman, one plane).
  static std::vector<DVec3> clipped(const std::vector<DVec3>& corners) {
    constexpr double kNear_m = 0.05;
    std::vector<DVec3> kept;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const DVec3 &from = corners[i], &to = corners[(i + 1) % corners.size()];
      const double before = -from.z - kNear_m, after = -to.z - kNear_m;
      if (before >= 0.0) kept.push_back(from);
      if ((before >= 0.0) != (after >= 0.0))
        kept.push_back(glm::mix(from, to, before / (before - after)));
    }
    return kept;
  }
  DVec2 project(const DVec3& view) const {
    return 0.5 * DVec2(counts_.width(), counts_.height()) +
           pixels_per_tangent_ * DVec2(view.x, -view.y) / -view.z;
  }
  void fill(const DVec2& p0, DVec2 p1, DVec2 p2) {
    if (edge(p0, p1, p2) < 0.0) std::swap(p1, p2);
    const DVec2 low = glm::min(glm::min(p0, p1), p2), high = glm::max(glm::max(p0, p1), p2);
    const int right = static_cast<int>(std::min<double>(counts_.width() - 1, std::floor(high.x)));
    const int bottom = static_cast<int>(std::min<double>(counts_.height() - 1, std::floor(high.y)));
    for (int y = static_cast<int>(std::max(0.0, std::floor(low.y))); y <= bottom; ++y) {
      for (int x = static_cast<int>(std::max(0.0, std::floor(low.x))); x <= right; ++x) {
        const DVec2 at{x + 0.5, y + 0.5};
        if (edge(p0, p1, at) > 0.0 && edge(p1, p2, at) > 0.0 && edge(p2, p0, at) > 0.0)
          ++counts_(x, y);
      }
    }
  }

  Pose view_from_world_;
  double pixels_per_tangent_;
  image::Plane<int> counts_;
};

/// Mean number of triangles along a line of sight, seen and hidden, fronts and backs.
inline double mean_depth_complexity(const Scene& scene, const Camera& camera) {
  DepthCounter counter(camera, 96, 64);
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    const auto at = [&](Index i) {
      return DVec3(instance.parent_from_object * DVec4(DVec3(mesh.positions[i]), 1.0));
    };
    for (const UVec3& t : mesh.triangles) counter.add(at(t.x), at(t.y), at(t.z));
  }
  return counter.mean();
}

}  // namespace macula::scene::measure
