// The room around the furniture: walls seen from inside, a floor, a ceiling with coffers and
// rosettes, skirting and cornice. x, z in [-half, half], floor at y = 0, meters.
#pragma once

#include "server/scene/scene.h"

namespace macula::scene::built_in {

struct Shell {
  Mesh walls, floor, ceiling, mouldings, window_frames, panes;
};
/// The wall at +x has `windows` windows; their panes close the room.
Shell room_shell(const Vec3& size, int windows);

}  // namespace macula::scene::built_in
