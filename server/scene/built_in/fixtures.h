// Things that shine, as meshes: glass and glow apart from what holds them, so that each gets its
// material. Meters; hanging things hang from the origin, standing ones stand on y = 0.
#pragma once

#include <cstdint>
#include <vector>

#include "server/scene/scene.h"

namespace macula::scene::built_in {

/// A pear-shaped bulb of this radius, its cap at the origin, hanging down; fronts outwards.
Mesh bulb(float radius, int columns, int rows);

struct StringOfLights {
  Mesh cable, bulbs;
};
/// Small bulbs on a cable that sags between two points; 120 triangles a bulb.
struct StringShape {
  float sag = 0.2F;  ///< m
  int count = 40;
  float bulb_radius = 0.014F;  ///< m
};
StringOfLights string_of_lights(const Vec3& from, const Vec3& to, const StringShape& shape,
                                std::uint64_t seed);

struct Screen {
  Mesh picture;  ///< curved towards the viewer, texture coordinates over the whole; faces +z
  Mesh case_;    ///< back and foot
};
/// Stands on its foot; `cells` along the width, square.
Screen screen(float width, float height, int cells);

struct Lamp {
  Mesh body, glow;
};
/// A shade of cloth that glows softly, on a turned foot; about `height` tall.
Lamp shaded_lamp(float height, float shade_radius);
/// A reflector on an arm with a bulb in it, facing down.
Lamp desk_lamp();
/// Eight arms with candle bulbs under a chain of `drop` meters.
Lamp chandelier(float drop, int arms);
/// A dome on a cord of `drop` meters, a bulb inside.
Lamp pendant(float drop, float radius);

/// Glowing lumps of charcoal in a heap about `radius` wide.
Mesh embers(float radius, int count, std::uint64_t seed);
/// Candles of various heights in a group: wax and flames.
Lamp candles(int count, float spread, std::uint64_t seed);

}  // namespace macula::scene::built_in
