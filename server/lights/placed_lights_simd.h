// Internal to the room: the vector loop of PlacedLights::arriving.
#pragma once

#include "server/lights/placed_lights.h"

namespace macula::lights {

/// Every triangle shines with its row's emission.
void arriving_from_placed(const PlacedLightTable& table, const LightDraws& draws,
                          const sampling::Vec2Batch& u, const sampling::Vec3Batch& points,
                          std::size_t count, AreaArrivalBatch& out);

}  // namespace macula::lights
