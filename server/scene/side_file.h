// NAME.macula.toml beside NAME.gltf: what a scene file cannot say. All keys are optional:
//   meters_per_unit = 0.01            # size of the file's unit
//   exposure_ev = 1.0                 # radiance is multiplied by 2^exposure_ev
//   tone_curve = "filmic"             # or "linear"
//   ambient = [0.3, 0.35, 0.4]        # stands in for light reflected many times
//   ambient_distance_m = 3.0          # occluders beyond do not count
//   environment = "sky.exr"           # equirectangular, in the scene's folder; or radiance [r, g,
//   b] environment_yaw_deg = 90.0        # turned to the left about +Y; at 0 its middle lies at -Z
//   environment_scale = 1.0           # times its radiance
//   [scene_from_stage]                # where the viewer stands: floor level, meters
//   position_m = [0.0, 0.0, 2.0]
//   yaw_deg = 90.0                    # to the left about +Y; or rotation = [x, y, z, w]
//   [[light]]                         # any number; added to the scene's own
//   kind = "point"                    # "spot", "directional"
//   position_m = [0.0, 3.0, 0.0]
//   direction = [0.0, -1.0, 0.0]
//   intensity = [10.0, 10.0, 10.0]    # W/sr, or W/m^2 for directional
//   inner_cone_deg = 20.0
//   outer_cone_deg = 30.0
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "server/scene/scene.h"
#include "shared/base/result.h"

namespace macula::scene {

struct SideFile {
  std::optional<double> meters_per_unit;
  std::optional<Pose> scene_from_stage;
  std::optional<float> exposure_ev;
  std::optional<image::ToneCurve> tone_curve;
  std::optional<Rgb> ambient;
  std::optional<double> ambient_distance_m;
  std::optional<std::string> environment_file;  ///< relative to the scene's folder
  std::optional<Rgb> environment_color;         ///< excludes the file
  double environment_yaw_deg = 0.0, environment_scale = 1.0;
  std::vector<Light> lights;
};

/// The side file's path of a scene file.
std::filesystem::path side_file_of(const std::filesystem::path& scene_file);
/// Empty where there is no such file. An unknown key or a value out of range is an error with its
/// line.
Result<SideFile> read_side_file(const std::filesystem::path& path);

}  // namespace macula::scene
