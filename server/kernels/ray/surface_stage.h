// The surface stage: from rays that met triangles to points ready to be lit, in vectors. Rays are
// taken instance by instance, so that mesh, transform, material and textures are the same for a
// whole vector; what a point becomes depends on that point alone. shade_point() says the same of
// one point at a time, for distance fields.
#pragma once

#include <cstdint>
#include <span>

#include "server/kernels/ray/lighting.h"
#include "server/shading/bsdf_batch.h"
#include "server/shading/surface_batch.h"
#include "server/visibility/ray_stream.h"

namespace macula::kernels::ray {

/// The rays of a stream that met something, sorted by instance in the order they first appear.
class HitGroups {
 public:
  explicit HitGroups(const visibility::HitStream& hits, std::size_t count);

  std::size_t size() const { return groups_; }
  /// Indices into the stream, ascending; all met the same instance.
  std::span<const std::uint16_t> rays(std::size_t group) const {
    return {order_ + first_[group], static_cast<std::size_t>(first_[group + 1] - first_[group])};
  }

 private:
  std::size_t groups_ = 0;
  std::uint16_t first_[sampling::kBatch + 1];
  std::uint16_t order_[sampling::kBatch];
};

/// One group on its way. What comes in first, then what is made of it.
struct SurfaceGroup {
  scene::Index instance = 0;
  shading::PointsOnTriangles points;
  sampling::Vec3Batch direction;     ///< of the rays, any length
  sampling::FloatBatch t;            ///< in lengths of their direction
  sampling::FloatBatch sample_area;  ///< on the tangent plane; 0: textures unfiltered

  shading::SurfaceBatch surfaces;
  shading::FootprintBatch footprints;
  shading::BsdfBatch bsdfs;
  shading::ReflectorBatch reflectors;
  sampling::Vec3Batch ray_origin;  ///< as LitPoints::ray_origin

  /// Reads what the rays of one group met; sample_area is the caller's.
  void collect(const visibility::RayStream& rays, const visibility::HitStream& hits,
               std::span<const std::uint16_t> group);
  /// Makes everything else.
  void shade(const SceneFrame& scene, const Config& config);
  /// Point k's by itself, for terms that draw directions from it.
  shading::Reflector reflector(std::size_t k) const;
  /// Towards the eye of point k: of front faces only.
  Rgb emission(std::size_t k, const SceneFrame& scene) const;
};

/// Whether points of the scene can go through this stage: there are triangles.
bool shades_in_vectors(const SceneFrame& scene);

}  // namespace macula::kernels::ray
