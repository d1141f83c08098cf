// From a file's own units and silence to a scene in meters with complete settings: the side file's
// word first, then a guess, and every guess leaves a sentence in settings.guesses.
#pragma once

#include "server/scene/scene.h"
#include "server/scene/side_file.h"

namespace macula::scene {

/// Scales the scene to meters and fills its settings and, where it has no light at all, gives it
/// some.
void settle(Scene& scene, const SideFile& side);

/// Where a scene's origin belongs whose stage stands there: 0 within a kilometer of it, beyond that
/// at the stage, in whole meters. Floats lose a tenth of a millimeter with every kilometer.
DVec3 origin_for_stage(const DVec3& stage);
/// Moves a scene's origin there. Settings::file_from_scene_m takes the move back.
void recentre(Scene& scene);

/// By the scene's largest extent, in its units: rooms and buildings are 2 to 200 m.
double guess_meters_per_unit(double extent);

}  // namespace macula::scene
