// Files that assimp reads (OBJ with MTL, PLY, STL, OFF, FBX, COLLADA, 3DS) -> Scene, in the file's
// own units; settings are still empty. Parsing happens in a confined process; everything that comes
// back is checked before it is used. An Error names the file, the place in it and what is allowed.
#pragma once

#include <string>

#include "server/scene/scene.h"
#include "shared/base/result.h"

namespace macula::scene::assimp {

/// Whether the path's suffix is one of formats().
bool reads(const std::string& path);
/// ".obj, .ply, ..."
std::string list_of_suffixes();

struct ImportedScene {
  Scene scene;
  double meters_per_unit = 0.0;  ///< as the file says; 0: it does not
};
Result<ImportedScene> import_file(const std::string& path);

}  // namespace macula::scene::assimp
