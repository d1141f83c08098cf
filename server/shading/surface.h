// SurfaceTable: where and how a surface lies at a point named by instance, triangle and barycentric
// coordinates. World space, meters. Safe from any thread but while it moves; refers to the scene
// and its pose, which must outlive it.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "server/scene/animation.h"
#include "server/shading/surface_batch.h"

namespace macula::shading {

struct Surface {
  DVec3 position{0.0};          ///< interpolated, free of the error of a long ray
  Vec3 geometric_normal{0.0F};  ///< unit, towards the front face; 0 for a degenerate triangle
  Vec3 shading_normal{0.0F};    ///< unit, interpolated; the geometric one where a mesh has none
  Vec2 uv{0.0F};
  scene::Index material = 0;
  /// What rounding of rays to this point grows with beside its coordinates: the larger of the
  /// triangle's two edges at its first vertex and the object's translation, world, in the largest
  /// coordinate.
  float span_m = 0.0F;
};

class SurfaceTable {
 public:
  SurfaceTable(const scene::Scene& scene, const scene::ScenePose& pose);
  /// At time 0; for scenes whose meshes keep their shape.
  explicit SurfaceTable(const scene::Scene& scene);
  /// Takes these instances, ascending, to where another pose of the same scene has them.
  void move(const scene::Scene& scene, std::span<const scene::Index> instances,
            const scene::ScenePose& pose);

  /// The point (1 - u - v) p0 + u p1 + v p2.
  Surface at(scene::Index instance, scene::Index triangle, const Vec2& barycentric) const;
  /// The same of many points of one instance, in vectors: directions and texture coordinates within
  /// 1e-5, positions rounded to floats (within a unit in their last place).
  void at(scene::Index instance, const PointsOnTriangles& points, SurfaceBatch& out) const;
  /// Two steps that bring what at() reads near: of triangles, then of their vertices. For loops
  /// over points that lie anywhere; they change nothing.
  void fetch_triangle(scene::Index instance, scene::Index triangle) const;
  void fetch_vertices(scene::Index instance, scene::Index triangle) const;
  /// Texture length per meter on a triangle: the square root of the ratio of its areas; 0 without
  /// texture coordinates or area. Exact under rotations and uniform scales.
  float uv_per_meter(scene::Index instance, scene::Index triangle) const;
  scene::Index material(scene::Index instance) const { return instances_[instance].material; }
  std::size_t instance_count() const { return instances_.size(); }

 private:
  using Densities = std::vector<std::vector<float>>;  ///< per mesh, per triangle, object space
  struct Placed {
    const scene::Mesh* mesh;
    std::span<const Vec3> positions, normals;  ///< the mesh's, as the pose has them
    const std::vector<float>* uv_per_unit;     ///< of the shape at rest
    DMat3 world_from_object;
    DVec3 translation;
    Mat3 normal_from_object;  ///< inverse transpose: keeps fronts in front under mirroring too
    float meters_per_unit;    ///< cube root of the volume scale
    float stretch;            ///< most that the largest coordinate of a vector grows
    scene::Index material;
  };
  static Placed place(const scene::Scene& scene, scene::Index instance,
                      const scene::ScenePose& pose, const Densities& densities);

  std::shared_ptr<const Densities> uv_per_unit_;  ///< shared by copies of the table
  std::vector<Placed> instances_;
};

}  // namespace macula::shading
