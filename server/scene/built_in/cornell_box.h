// The Cornell box's room and blocks, for the scenes that put their own lights into it.
#pragma once

#include "server/scene/built_in/builder.h"

namespace macula::scene::built_in {

struct CornellMaterials {
  Index white = 0, red = 0, green = 0;
};
/// Floor, ceiling and three walls; 2.4 m wide, open towards +z at z = 0, floor at y = 0.
CornellMaterials add_cornell_room(SceneBuilder& builder);
/// The short and the tall block.
void add_cornell_blocks(SceneBuilder& builder, Index material);

}  // namespace macula::scene::built_in
