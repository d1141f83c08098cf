#include "client/app/warp_stage.h"

#include <algorithm>

#include "client/app/age_badge.h"
#include "client/frames/for_each_eye.h"

namespace macula::client_app {

void WarpStage::make_room(const EyeRig& rig) {
  warpers_.resize(rig.eyes.size());
  eyes_.inverse_depths_per_m.resize(rig.eyes.size());
  for (std::size_t eye = eyes_.colors.size(); eye < rig.eyes.size(); ++eye) {
    const foveation::Display& display = rig.eyes[eye].display;
    eyes_.colors.emplace_back(display.width_px, display.height_px);
  }
}

std::vector<reprojection::WarpReport> WarpStage::warp(const frames::DecodedFrame& frame,
                                                      const Pose& stage_from_head,
                                                      const EyeRig& rig) {
  make_room(rig);
  const std::size_t eyes = std::min(rig.eyes.size(), frame.eyes.size());
  std::vector<reprojection::WarpReport> reports(eyes);
  frames::for_each_eye(eyes, [&](std::size_t eye) {
    const net::FrameView& view = frame.begin.views[eye];
    const reprojection::SourceView source{view.stage_from_view, view.grid, frame.eyes[eye].color,
                                          frame.eyes[eye].inverse_depth_per_m};
    const auto& [head_from_eye, display] = rig.eyes[eye];
    reports[eye] = warpers_[eye].warp(source, stage_from_head * head_from_eye, display, options_,
                                      eyes_.colors[eye]);
    if (depth_ == Depth::Keep) warpers_[eye].copy_inverse_depth(eyes_.inverse_depths_per_m[eye]);
  });
  return reports;
}

void WarpStage::mark_age(Nanoseconds age) {
  for (image::Plane<Rgb8>& picture : eyes_.colors) draw_age_badge(picture, age);
}

}  // namespace macula::client_app
