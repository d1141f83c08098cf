// `macula-bench still`: one view of a scene for one eye, written as linear EXR or tone-mapped PNG.
// The everyday tool for looking at a kernel and for comparing it with outside references.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/base/result.h"
#include "shared/math/vec.h"
#include "shared/units/angle.h"

namespace macula::bench {

enum class StillMode { Exact, Fast };
enum class StillMaterial { AsInScene, Lambert };
enum class StillGrid { Uniform, Foveal };
/// Planes besides radiance that a still can write.
enum class StillPlane { Depth, Normal, Albedo, Id, Rate, Samples, Steps, Variance };

/// A camera given by hand, in the scene file's own units and axes.
struct StillCamera {
  DVec3 eye{0.0};
  DVec3 target{0.0};
  DVec3 up{0.0, 1.0, 0.0};
  Degrees vertical_fov{60.0};  ///< in (0, 180)
};

/// In view space: yaw to the right, pitch upwards; (0, 0) is the view axis.
struct StillGaze {
  Degrees yaw{0.0};
  Degrees pitch{0.0};
};

struct StillOptions {
  std::string scene;            ///< built-in name or file
  std::string kernel = "auto";  ///< name in the kernel table
  StillMode mode = StillMode::Exact;
  std::string knobs;                  ///< of the kernel, "name=value ..."
  bool perceived_lights = false;      ///< kernel lightcuts, mode fast: light_samples is not used
  int light_samples = 8;              ///< --lspp: area-light samples per primary sample, >= 1
  int samples_per_cell = 1;           ///< --spp: primary samples a cell, >= 1
  std::string camera_name;            ///< empty: the scene's own camera, unless `camera` is given
  std::optional<StillCamera> camera;  ///< wins over camera_name
  int width_px = 512;
  int height_px = 512;
  StillGaze gaze;
  StillMaterial material = StillMaterial::AsInScene;
  double time_s = 0.0;             ///< --time: on the scene's clock
  std::optional<int> bounces;      ///< 0 or 1; none: the kernel's own number
  std::vector<StillPlane> planes;  ///< --aov; layers of the EXR, and a PNG each
  StillGrid grid = StillGrid::Uniform;
  std::string rate_model = "cortical";  ///< preset of shared/foveation/rate.h
  std::uint64_t seed = 1;
  int threads = 0;   ///< 0: what the machine offers
  std::string out;   ///< FILE.exr (linear radiance) or FILE.png (tone-mapped)
  std::string json;  ///< report; empty: none
};

/// Renders and writes. Errors name the option or file at fault and what is allowed.
Result<void> run_still(const StillOptions& options);

}  // namespace macula::bench
