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

  /// A mirroring transform places a mirrored copy of the mesh (made once), one that squeezes space
  /// to a plane a copy that is moved itself and shaded flat. `world_from_object` is finite. Too
  /// many copies are an error that names `place`.
  Result<void> place(Index mesh, const DMat4& world_from_object, const std::string& place);

 private:
  bool may_copy(Index mesh);
  Index mirrored(Index mesh);
  Index flattened(Index mesh, const DMat4& world_from_object);

  Scene& scene_;
  std::map<Index, Index> mirrored_;
  std::size_t copied_ = 0;  ///< triangles
};

}  // namespace macula::scene
