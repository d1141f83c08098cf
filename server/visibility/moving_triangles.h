// MovingTriangles: the TriangleScenes of a scene that moves. What stands still is built once and
// shared by all of them; what a joint carries hangs in a top level of its own, rebuilt for each
// pose; meshes that change shape are refitted to their vertices, starting from those at rest, so
// that a pose gives the same structure whichever came before. World space, meters.
#pragma once

#include <memory>

#include "server/scene/animation.h"
#include "server/visibility/visibility.h"

namespace macula::visibility {

class MovingTriangles {
 public:
  /// Builds on all cores what stands still, where `pose` has it. The scene must outlive this; the
  /// TriangleScenes need neither. Errors: as TriangleScene::create.
  static Result<std::unique_ptr<MovingTriangles>> create(const scene::Scene& scene,
                                                         const scene::MovingParts& moving,
                                                         const scene::ScenePose& pose,
                                                         const Options& options = {});
  ~MovingTriangles();
  MovingTriangles(const MovingTriangles&) = delete;
  MovingTriangles& operator=(const MovingTriangles&) = delete;

  /// One more TriangleScene, at `pose`. Calls of make and move must not overlap; queries of other
  /// TriangleScenes may go on meanwhile.
  Result<std::shared_ptr<TriangleScene>> make(const scene::ScenePose& pose);
  /// Takes a scene of make(), which nobody is querying, to `pose`. An instance whose transform has
  /// no volume or is not finite is not there. After an error the scene is of no more use.
  Result<void> move(TriangleScene& triangles, const scene::ScenePose& pose) const;

 private:
  struct Still;
  explicit MovingTriangles(std::unique_ptr<Still> still);
  std::unique_ptr<Still> still_;
};

}  // namespace macula::visibility
