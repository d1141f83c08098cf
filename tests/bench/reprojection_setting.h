// What the reprojection experiments render: frames of one eye on the display's own raster carried
// on over a guard band, and pictures at the exact display pose, by the same kernel with the same
// fixed 3x3 samples a cell, so that only the warp makes a difference. One caller.
#pragma once

#include <memory>
#include <string>

#include "client/reprojection/warp.h"
#include "server/kernels/kernel.h"
#include "shared/image/tone.h"

namespace macula::bench {

/// A rendered frame of one eye; owns what SourceView refers to.
struct SourcePicture {
  Pose stage_from_view;
  PixelGrid grid;
  image::Plane<Rgb8> color;
  image::Plane<float> inverse_depth_per_m;
  reprojection::SourceView view() const {
    return {stage_from_view, grid, color, inverse_depth_per_m};
  }
};

/// The display's raster with cells of 1 / `scale` of a pixel, going on for `guard` on every side
/// (cut off at 80 degrees from the axis).
PixelGrid guarded_raster(const foveation::Display& display, Degrees guard, double scale = 1.0);

class ReprojectionSetting {
 public:
  /// `material` "lambert" replaces every material by its base colour; "full" keeps them and takes
  /// 4 ambient rays a sample. Errors: an unknown scene, a kernel that cannot render it.
  static Result<ReprojectionSetting> create(const std::string& scene, const std::string& material,
                                            int threads);

  SourcePicture render(const Pose& stage_from_view, const PixelGrid& grid);
  /// The scene's first camera, on the stage; at its origin where there is none.
  const Pose& stage_from_camera() const { return stage_from_camera_; }

 private:
  ReprojectionSetting() = default;

  std::shared_ptr<const kernels::SceneFrame> frame_;
  std::unique_ptr<kernels::Kernel> kernel_;
  std::unique_ptr<kernels::TileScheduler> scheduler_;
  image::Tone tone_;
  Pose scene_from_stage_, stage_from_camera_;
};

}  // namespace macula::bench
