// What stands in a street: each on y = 0 in a frame of its own, meters.
#pragma once

#include "server/scene/scene.h"

namespace macula::scene::built_in::city {

struct Car {
  Mesh body, glass, dark;  ///< paint; windows; tyres and trim. Length along z, front at -z
};
Car car(float length, float height);

struct StreetLamp {
  Mesh post, globe;
};
inline constexpr float kLampHeight = 4.4F;  ///< m, of the globe
StreetLamp street_lamp();

/// Slats on two cast feet.
Mesh park_bench();
Mesh bollard();
/// One traffic light with its three lenses towards +z, without their glow.
Mesh traffic_light();

}  // namespace macula::scene::built_in::city
