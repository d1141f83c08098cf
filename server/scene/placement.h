// Placement: puts a mesh into the scene by any affine transform and keeps what Scene promises of
// instances: invertible, never mirroring. Source: glTF 2.0, 3.7.4 (winding under mirroring).
#pragma once

#include <map>
#include <string>

#include "server/scene/scene.h"
#include "shared/base/result.h"

namespace macula::scene {

class Placement {
 public:
  /// `scene` must outlive it.
  explicit Placement(Scene& scene) : scene_(scene) {}

  /// Triangles in all copies that may be made.
  static constexpr std::size_t kMostCopied = std::size_t{1} << 24;

  /// Places `wanted` (its transform finite). A transform that mirrors places a mirrored copy of the
  /// mesh (made once), one that squeezes space to a plane a copy that is moved itself and shaded
  /// flat. Below a joint, whether it mirrors is told by `world_from_joint`, the joint's own
  /// transform at rest. Too many copies are an error that names `place`.
  Result<void> place(const Instance& wanted, const std::string& place,
                     const DMat4& world_from_joint = DMat4{1.0});

 private:
  bool may_copy(Index mesh);
  Index mirrored(Index mesh);
  Index flattened(const Instance& wanted);

  Scene& scene_;
  std::map<Index, Index> mirrored_;
  std::size_t copied_ = 0;  ///< triangles
};

}  // namespace macula::scene
