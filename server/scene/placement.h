// Placement: puts a mesh into the scene by any affine transform and keeps what Scene promises of
// instances: invertible, never mirroring. Source: glTF 2.0, 3.7.4 (winding under mirroring).
#pragma once

#include <map>

#include "server/scene/scene.h"

namespace macula::scene {

class Placement {
 public:
  /// `scene` must outlive it.
  explicit Placement(Scene& scene) : scene_(scene) {}

  /// A mirroring transform places a mirrored copy of the mesh (made once), one that squeezes space
  /// to a plane a copy that is moved itself and shaded flat. `transform` is finite.
  void place(Index mesh, const DMat4& world_from_object);

 private:
  Index mirrored(Index mesh);
  Index flattened(Index mesh, const DMat4& world_from_object);

  Scene& scene_;
  std::map<Index, Index> mirrored_;
};

}  // namespace macula::scene
