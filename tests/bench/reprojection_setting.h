// What the reprojection experiments render: frames of one eye on the display's own raster carried
// on over a guard band, and pictures at the exact display pose, by the same kernel with the same
// fixed 3x3 samples a cell, so that only the warp makes a difference. One caller.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/reprojection/warp.h"
#include "server/disocclusion/hidden_layer.h"
#include "server/kernels/kernel.h"
#include "shared/codec/hidden_layer.h"
#include "shared/image/tone.h"

namespace macula::bench {

/// A rendered frame of one eye; owns what SourceView refers to.
struct SourcePicture {
  Pose stage_from_view;
  PixelGrid grid;
  image::Plane<Rgb8> color;
  image::Plane<float> inverse_depth_per_m;
  std::optional<codec::HiddenLayerPlanes> behind{};     ///< the second layer
  std::optional<reprojection::HiddenPicture> hidden{};  ///< the same, as the warp draws it
  std::size_t bytes = 0, hidden_bytes = 0;  ///< of the frame and of its second layer; 0: not coded
  std::vector<std::uint8_t> depth_residual{};  ///< per 8x8 cells; empty: depth is exact
  float residual_step_per_m = 0.0F;
  double cpu_ms = 0.0, hidden_cpu_ms = 0.0;  ///< of rendering each layer, over all threads
  double hidden_cells_pct = 0.0;             ///< of all cells
  reprojection::SourceView view() const {
    return {stage_from_view, grid, color, inverse_depth_per_m, hidden ? &*hidden : nullptr};
  }
};

/// The picture as a client gets it: JPEG of the default quality, inverse depth, and the second
/// layer as the server codes it. Errors: the codecs'.
Result<SourcePicture> coded(const SourcePicture& picture);

/// The display's raster with cells of 1 / `scale` of a pixel, going on for `guard` on every side
/// (cut off at 80 degrees from the axis).
PixelGrid guarded_raster(const foveation::Display& display, Degrees guard, double scale = 1.0);

class ReprojectionSetting {
 public:
  /// `material` "lambert" replaces every material by its base colour; "full" keeps them and takes
  /// 4 ambient rays a sample. Errors: an unknown scene, a kernel that cannot render it.
  static Result<ReprojectionSetting> create(const std::string& scene, const std::string& material,
                                            int threads);

  /// With a second layer for an eye that moves by up to `view_cell_m`; 0: without one.
  SourcePicture render(const Pose& stage_from_view, const PixelGrid& grid,
                       double view_cell_m = 0.0);
  /// Inverse depth (1/m) through the middle of every cell.
  image::Plane<float> depth(const Pose& stage_from_view, const PixelGrid& grid);
  /// The scene's first camera, on the stage; at its origin where there is none.
  const Pose& stage_from_camera() const { return stage_from_camera_; }

 private:
  ReprojectionSetting() = default;
  void add_hidden(const kernels::View& view, const image::Plane<float>& depth_m, double view_cell_m,
                  SourcePicture& picture);

  std::shared_ptr<const kernels::SceneFrame> frame_;
  std::unique_ptr<kernels::Kernel> kernel_;
  std::unique_ptr<kernels::TileScheduler> scheduler_;
  image::Tone tone_;
  Pose scene_from_stage_, stage_from_camera_;
};

}  // namespace macula::bench
