// Light that no tree holds, at points of a tile: lights that are nowhere (before the cut's),
// ambient light and the environment (after it). The same numbers in the same order as kernel
// `ray`'s.
#pragma once

#include <span>

#include "server/kernels/lightcuts/light_stream.h"

namespace macula::kernels::lightcuts {

/// slots.size() == points.count.
void add_lights_apart(const SceneFrame& scene, const ray::LitPoints& points,
                      ray::LightingWork& work, std::span<Rgb> slots);
void add_surroundings(const SceneFrame& scene, const ray::Config& config,
                      const ray::LitPoints& points, ray::LightingWork& work, std::span<Rgb> slots);

}  // namespace macula::kernels::lightcuts
