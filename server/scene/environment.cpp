#include "server/scene/environment.h"

#include <cmath>

#include "server/exr/exr.h"
#include "server/scene/files.h"
#include "shared/base/text.h"

namespace macula::scene {
namespace {

constexpr int kLargestSide_px = 8192;

/// What is no radiance is set to 0; how many texels that were.
std::size_t repair(image::Plane<Rgb>& radiance) {
  std::size_t repaired = 0;
  for (Rgb& value : radiance.pixels()) {
    const bool good =
        math::is_finite(value) && value.x >= 0.0F && value.y >= 0.0F && value.z >= 0.0F;
    if (good) continue;
    for (int c = 0; c < 3; ++c)
      value[c] = std::isfinite(value[c]) ? std::max(value[c], 0.0F) : 0.0F;
    ++repaired;
  }
  return repaired;
}

Result<image::Plane<Rgb>> read_picture(const std::string& file,
                                       const std::filesystem::path& scene_file) {
  const auto path = SceneFolder(scene_file).resolve(file);
  if (!path) return forward(path);
  return exr::read(path->string(), kLargestSide_px);
}

}  // namespace

Result<std::optional<Environment>> load_environment(const SideFile& side,
                                                    const std::filesystem::path& scene_file,
                                                    Scene& scene) {
  Environment environment;
  environment.yaw = Degrees{side.environment_yaw_deg};
  environment.scale = static_cast<float>(side.environment_scale);
  if (side.environment_color) {
    environment.radiance(0, 0) = *side.environment_color;
    return environment;
  }
  if (!side.environment_file) return std::nullopt;
  auto picture = read_picture(*side.environment_file, scene_file);
  if (!picture) return forward(picture);
  environment.radiance = std::move(*picture);
  if (const std::size_t repaired = repair(environment.radiance); repaired > 0) {
    scene.warnings.push_back(
        base::concat("environment: ", repaired, " negative or non-finite texels set to 0"));
  }
  return environment;
}

}  // namespace macula::scene
