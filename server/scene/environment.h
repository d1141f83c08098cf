// The environment a side file names: read, checked and turned as it says. World space, linear
// Rec.709 radiance. Pure but for reading the file.
#pragma once

#include <filesystem>
#include <optional>

#include "server/scene/side_file.h"

namespace macula::scene {

/// nullopt where the side file names none. The picture lies inside the scene's folder and is at
/// most 8192 px wide; values that are negative or not finite become 0, with a warning in `scene`.
Result<std::optional<Environment>> load_environment(const SideFile& side,
                                                    const std::filesystem::path& scene_file,
                                                    Scene& scene);

}  // namespace macula::scene
