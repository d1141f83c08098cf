// From a file's own units and silence to a scene in meters with complete settings: the side file's
// word first, then a guess, and every guess leaves a sentence in settings.guesses.
#pragma once

#include "server/scene/scene.h"
#include "server/scene/side_file.h"

namespace macula::scene {

/// Scales the scene to meters and fills its settings and, where it has no light at all, gives it
/// some.
void settle(Scene& scene, const SideFile& side);

/// By the scene's largest extent, in its units: rooms and buildings are 2 to 200 m.
double guess_meters_per_unit(double extent);

}  // namespace macula::scene
