// WarpPass: the warp of client/reprojection on OpenGL 3.3, stage by stage the same: the grid's
// cells as a mesh, cut at silhouettes by the eye's actual offset, the second layer, holes filled
// from the farther side. The CPU's warp is the reference; what it draws as blocks is drawn cell by
// cell here, which moves nothing by more than WarpOptions::detail_px. Every call needs the context
// it was created in to be current.
#pragma once

#include <array>
#include <memory>

#include "client/display/gl/picture_space.h"
#include "client/reprojection/warp.h"
#include "shared/base/result.h"

namespace macula::display {

class WarpPass {
 public:
  /// An Error where the context is older than OpenGL 3.3 or the driver refuses the shaders.
  static Result<std::unique_ptr<WarpPass>> create();
  ~WarpPass();
  WarpPass(const WarpPass&) = delete;
  WarpPass& operator=(const WarpPass&) = delete;

  /// Copies a frame to the GPU; it stays until the next one.
  void upload(const reprojection::SourceView& source);
  /// As reprojection::warp, of the frame uploaded last; at most 16384 pixels a side.
  reprojection::WarpReport warp(const Pose& stage_from_display, const foveation::Display& display,
                                const reprojection::WarpOptions& options, image::Plane<Rgb8>& out,
                                image::Plane<reprojection::Coverage>* coverage = nullptr);

 private:
  struct Programs {
    unsigned mesh = 0, resolve = 0;
  };
  /// A row of floats that shaders read by index.
  struct FloatBuffer {
    unsigned buffer = 0, texture = 0;
  };
  /// One layer's planes.
  struct Layer {
    unsigned color = 0, inverse_depth = 0, cells = 0;
  };
  explicit WarpPass(const Programs& programs);
  void resize(PictureSize size);
  void draw_layer(const Layer& layer, int layer_row, const foveation::Display& display);
  void resolve(const foveation::Display& display, const reprojection::WarpOptions& options);
  reprojection::WarpReport read_back(image::Plane<Rgb8>& out,
                                     image::Plane<reprojection::Coverage>* coverage);
  void set_mesh_uniforms(const Pose& stage_from_display, const foveation::Display& display,
                         const reprojection::WarpOptions& options);

  Programs programs_;
  unsigned vertices_ = 0;  ///< an empty vertex array
  FloatBuffer x_tangents_, y_tangents_;
  Layer seen_, hidden_;
  bool has_hidden_ = false;
  Pose stage_from_view_;
  PixelGrid grid_;
  unsigned places_ = 0, depth_ = 0, place_target_ = 0;  ///< textures and their framebuffer
  unsigned picture_ = 0, picture_target_ = 0;
  PictureSize size_;
};

}  // namespace macula::display
