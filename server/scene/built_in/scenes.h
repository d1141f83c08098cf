// The generators of the built-in scenes. Deterministic: the same seed gives the same bytes.
// Meters, Y up, floor at y = 0; settings.scene_from_stage is where the viewer stands.
#pragma once

#include <cstdint>

#include "server/scene/scene.h"

namespace macula::scene::built_in {

Scene cornell(std::uint64_t seed);
Scene posts(std::uint64_t seed);
Scene moving(std::uint64_t seed);
Scene atrium(std::uint64_t seed);
Scene city_of_houses(std::uint64_t seed);
Scene city_instanced(std::uint64_t seed);
Scene nave(std::uint64_t seed);
Scene tunnel_geometry(std::uint64_t seed);
Scene tunnel_maps(std::uint64_t seed);
Scene cornell_lights(std::uint64_t seed);
Scene study(std::uint64_t seed);
Scene room(std::uint64_t seed);
Scene yard(std::uint64_t seed);

}  // namespace macula::scene::built_in
