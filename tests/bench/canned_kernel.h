// A source that costs next to nothing: a texture of equal power in every octave (as natural
// pictures have), panned by the head's turn, over gentle waves of depth. It stands in for a kernel
// where the stream alone is measured. A cell's colour is a function of its direction and the pose:
// whoever knows a frame's header knows its picture.
#pragma once

#include "server/kernels/kernel.h"
#include "shared/image/plane.h"

namespace macula::bench {

class CannedPattern {
 public:
  /// `noise`: standard deviation of a grain that differs from frame to frame, in display levels.
  explicit CannedPattern(double noise_levels = 0.0);

  /// Linear radiance and depth on a grid.
  void fill(const Pose& world_from_view, const PixelGrid& grid, std::uint64_t frame,
            image::Plane<Rgb>& radiance, image::Plane<float>& depth_m) const;

 private:
  std::vector<Rgb> texture_;  ///< kSide x kSide, periodic
  double noise_ = 0.0;
};

class CannedKernel final : public kernels::Kernel {
 public:
  explicit CannedKernel(std::shared_ptr<const CannedPattern> pattern)
      : pattern_(std::move(pattern)) {}
  kernels::FrameReport render(const kernels::FrameRequest& request, const kernels::SceneFrame&,
                              kernels::History&, scheduling::TileScheduler&,
                              kernels::FrameBuffers& out) const override;
  void shade(std::span<const kernels::SurfacePoint>, const kernels::SceneFrame&,
             scheduling::TileScheduler&, std::span<Rgb> out) const override;

 private:
  std::shared_ptr<const CannedPattern> pattern_;
};

}  // namespace macula::bench
