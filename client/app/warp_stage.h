// WarpStage: the newest frame brought to the display's pose, both eyes at the same time. It keeps
// its pictures between refreshes. One caller.
#pragma once

#include <vector>

#include "client/app/eye_rig.h"
#include "client/display/headless/picture_writer.h"
#include "client/frames/decode.h"
#include "client/reprojection/warp.h"

namespace macula::client_app {

/// What the eyes see, left first.
struct WarpedEyes {
  display::EyePictures colors;
  std::vector<image::Plane<float>> inverse_depths_per_m;  ///< empty planes unless asked for
};

class WarpStage {
 public:
  enum class Depth { Leave, Keep };
  WarpStage(const reprojection::WarpOptions& options, Depth depth)
      : options_(options), depth_(depth) {}

  /// Reports by eye. Eyes the frame does not have stay as they are.
  std::vector<reprojection::WarpReport> warp(const frames::DecodedFrame& frame,
                                             const Pose& stage_from_head, const EyeRig& rig);
  /// Says on the pictures how long ago their frame came, where that is long.
  void mark_age(Nanoseconds age);
  const WarpedEyes& eyes() const { return eyes_; }

 private:
  void make_room(const EyeRig& rig);

  const reprojection::WarpOptions options_;
  const Depth depth_;
  WarpedEyes eyes_;
  std::vector<reprojection::Warper> warpers_;  ///< by eye
};

}  // namespace macula::client_app
