// A distance field as a Scene: its materials, lights, cameras and settings in the words that
// kernels know; the field itself hangs on Scene::field. World space is the field's own, meters.
#pragma once

#include <memory>
#include <string>

#include "server/scene/scene.h"
#include "server/sdf/field.h"

namespace macula::scene {

Scene scene_of(std::shared_ptr<const sdf::Field> field);
/// Moves a field whose first camera stands far from its origin to it (settle.h); returns where the
/// new origin lies in the file.
DVec3 recentre(sdf::Field& field);

/// The field's point lights and suns at a moment on the scene's clock.
std::vector<Light> field_lights(const sdf::Field& field, double time_s);
std::vector<Camera> field_cameras(const sdf::Field& field, double time_s);

}  // namespace macula::scene
