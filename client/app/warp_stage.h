// WarpStage: the newest frame brought to the display's pose, both eyes at the same time. It keeps
// its pictures between refreshes. One caller.
#pragma once

#include <vector>

#include "client/app/eye_rig.h"
#include "client/display/headless/picture_writer.h"
#include "client/frames/decode.h"
#include "client/reprojection/warp.h"

namespace macula::client_app {

class WarpStage {
 public:
  WarpStage(const EyeRig& rig, const reprojection::WarpOptions& options);

  /// Reports by eye. Eyes the frame does not have stay black.
  std::vector<reprojection::WarpReport> warp(const frames::DecodedFrame& frame,
                                             const Pose& stage_from_head);
  const display::EyePictures& pictures() const { return pictures_; }

 private:
  const EyeRig rig_;
  const reprojection::WarpOptions options_;
  display::EyePictures pictures_;
  std::vector<reprojection::Warper> warpers_;  ///< by eye
};

}  // namespace macula::client_app
