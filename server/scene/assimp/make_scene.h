// A decoded parcel, of which nothing is believed yet -> Scene. Every number and index is checked or
// brought into its range; pictures are read from beside the file.
#pragma once

#include <string>

#include "server/scene/assimp/parcel.h"
#include "server/scene/scene.h"
#include "shared/base/result.h"

namespace macula::scene::assimp {

/// `path`: of the file the parcel was made from; errors name it and the place in it.
Result<Scene> make_scene(const std::string& path, Parcel parcel);

}  // namespace macula::scene::assimp
