#include "client/app/warp_stage.h"

#include <algorithm>

#include "client/frames/for_each_eye.h"

namespace macula::client_app {

WarpStage::WarpStage(const EyeRig& rig, const reprojection::WarpOptions& options)
    : rig_(rig), options_(options) {
  pictures_.assign(static_cast<std::size_t>(rig.eyes),
                   image::Plane<Rgb8>(rig.display.width_px, rig.display.height_px));
  warpers_.resize(pictures_.size());
}

std::vector<reprojection::WarpReport> WarpStage::warp(const frames::DecodedFrame& frame,
                                                      const Pose& stage_from_head) {
  const std::size_t eyes = std::min(pictures_.size(), frame.eyes.size());
  std::vector<reprojection::WarpReport> reports(eyes);
  frames::for_each_eye(eyes, [&](std::size_t eye) {
    const net::FrameView& view = frame.begin.views[eye];
    const reprojection::SourceView source{view.stage_from_view, view.grid, frame.eyes[eye].color,
                                          frame.eyes[eye].inverse_depth_per_m};
    const Pose stage_from_eye = stage_from_head * rig_.head_from_eye(static_cast<int>(eye));
    reports[eye] =
        warpers_[eye].warp(source, stage_from_eye, rig_.display, options_, pictures_[eye]);
  });
  return reports;
}

}  // namespace macula::client_app
