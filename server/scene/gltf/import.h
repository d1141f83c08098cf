// glTF 2.0 file -> Scene, in the file's own units; settings are still empty. Everything a file says
// is checked before it is used; an Error names the file, the place in it and what is allowed.
#pragma once

#include <string>

#include "server/scene/scene.h"
#include "shared/base/result.h"

namespace macula::scene::gltf {

Result<Scene> import_file(const std::string& path);

}  // namespace macula::scene::gltf
