// What moved by itself between two frames of a session, so that memories of pictures and of light
// follow it. World, meters. Changes of shape and of size are not followed.
#pragma once

#include "server/kernels/kernel.h"
#include "server/reconstruction/picture_memory.h"
#include "server/scene/animation.h"

namespace macula::kernels::culling {

/// Whether instances of the scene can move at all.
bool has_moving_objects(const SceneFrame& scene);
/// What of the pose tells where objects are.
scene::ScenePose places_of_objects(const SceneFrame& scene);

/// Which cells show an instance that moved rigidly since `before`. Reads surface_id. `before` of
/// another number of instances, as that of a first frame: nothing moved.
reconstruction::Movers movers_in(const ViewBuffers& buffers, const scene::ScenePose& before,
                                 const SceneFrame& scene);

}  // namespace macula::kernels::culling
