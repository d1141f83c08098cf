// The loops of LightList over many points, in vectors. Internal to this room.
#pragma once

#include "server/lights/light_list.h"

namespace macula::lights {

/// As LightList::arriving_area, with an emission of 1 from textured lights.
void arriving_from_table(const EmitterTable& table, const sampling::Vec2Batch& u,
                         const sampling::Vec3Batch& points, std::size_t count,
                         AreaArrivalBatch& out);

}  // namespace macula::lights
