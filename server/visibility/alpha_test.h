// AlphaTest: is a triangle mesh there at a point, by its material's alpha? Nearest texel, no mip
// maps. Owns copies of what it reads, so that it outlives the scene it was made from. Immutable.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "server/scene/scene.h"

namespace macula::visibility {

/// How much of a mesh alpha lets through, before any texel is read.
enum class AlphaUse { AlwaysThere, NeverThere, PerTexel };
AlphaUse alpha_use(const scene::Scene& scene, const scene::Mesh& mesh);

class AlphaTest {
 public:
  /// Of a mesh whose alpha_use is not NeverThere; one that is AlwaysThere answers yes everywhere.
  AlphaTest(const scene::Scene& scene, const scene::Mesh& mesh);
  /// u, v: barycentrics of vertices 1 and 2 of the triangle.
  bool is_there(std::uint32_t triangle, float u, float v) const;

 private:
  std::vector<UVec3> triangles_;
  std::vector<Vec2> texcoords_;  ///< transformed, in texture units
  image::Plane<std::uint8_t> alpha_;
  scene::Wrap wrap_u_ = scene::Wrap::Repeat, wrap_v_ = scene::Wrap::Repeat;
  float least_texel_ = 0.0F;  ///< alpha texel value from which the surface is there
};

}  // namespace macula::visibility
