// AlphaTest: is a triangle mesh there at a point, by its material's alpha? Read bilinearly at the
// finest level, no mip maps. Owns copies of what it reads, so that it outlives the scene it was
// made from. Immutable.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "server/scene/scene.h"
#include "server/visibility/ray_stream.h"

namespace macula::visibility {

/// How much of a mesh alpha lets through, before any point of it is asked.
enum class AlphaUse { AlwaysThere, NeverThere, PerPoint };
AlphaUse alpha_use(const scene::Scene& scene, const scene::Mesh& mesh);
/// Whether the mesh asks a ray for its BlendRule.
bool blends(const scene::Scene& scene, const scene::Mesh& mesh);

class AlphaTest {
 public:
  /// Of a mesh whose alpha_use is not NeverThere; one that is AlwaysThere answers yes everywhere.
  AlphaTest(const scene::Scene& scene, const scene::Mesh& mesh);
  bool blends() const { return blends_; }
  /// A Mask's answer. u, v: barycentrics of vertices 1 and 2 of the triangle.
  bool is_there(std::uint32_t triangle, float u, float v) const;
  /// A Blend's answer to a ray with this rule; `instance` tells its surfaces apart.
  bool is_there(std::uint32_t triangle, float u, float v, BlendRule rule,
                std::uint32_t instance) const;

 private:
  float texel(std::uint32_t triangle, float u, float v) const;  ///< alpha in [0, 255]

  std::vector<UVec3> triangles_;
  std::vector<Vec2> texcoords_;  ///< transformed, in texture units
  image::Plane<std::uint8_t> alpha_{1, 1, 255};
  scene::Wrap wrap_u_ = scene::Wrap::Repeat, wrap_v_ = scene::Wrap::Repeat;
  float least_texel_ = 0.0F;  ///< Mask: alpha texel value from which the surface is there
  float factor_ = 1.0F;       ///< Blend: coverage of a texel that is wholly there
  bool blends_ = false;
};

}  // namespace macula::visibility
