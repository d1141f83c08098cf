// WarpStage: the newest frame brought to the display's pose, both eyes at the same time. It keeps
// its pictures between refreshes. One caller.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "client/app/eye_rig.h"
#include "client/display/gl/warp_pass.h"
#include "client/display/headless/picture_writer.h"
#include "client/frames/decode.h"
#include "client/reprojection/error_bound.h"
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
  /// On::Gl needs the display's OpenGL context to be current whenever it warps, and keeps no depth.
  enum class On { Cpu, Gl };
  /// OneByOne: on the caller's thread, whose clock then tells what they cost.
  enum class Eyes { AtOnce, OneByOne };
  WarpStage(const reprojection::WarpOptions& options, Depth depth, On on = On::Cpu,
            Eyes at_once = Eyes::AtOnce)
      : options_(options), depth_(depth), on_(on), at_once_(at_once) {}

  /// Reports by eye. Eyes the frame does not have stay as they are. `settled`: 0 to 1, how far the
  /// picture has settled (settle.h).
  std::vector<reprojection::WarpReport> warp(const frames::DecodedFrame& frame,
                                             const Pose& stage_from_head, const EyeRig& rig,
                                             double settled = 0.0);
  /// How far off the last warp may have shown anything, over the eyes; nullopt where the frame does
  /// not say how exact its depth is.
  std::optional<reprojection::ErrorBound::Summary> bound(
      const frames::DecodedFrame& frame, const Pose& stage_from_head, const EyeRig& rig,
      const reprojection::PoseDoubt& doubt) const;
  /// Says on the pictures how long ago their frame came, where that is long.
  void mark_age(Nanoseconds age);
  const WarpedEyes& eyes() const { return eyes_; }

 private:
  void make_room(const EyeRig& rig);
  reprojection::WarpReport warp_eye(const reprojection::SourceView& source, const Pose& at,
                                    const foveation::Display& display, std::size_t eye);
  /// The eyes' passes; On::Cpu from then on where the driver has none.
  void make_passes(std::size_t eyes);
  reprojection::WarpReport warp_on_gl(const frames::DecodedFrame& frame,
                                      const reprojection::SourceView& source, const Pose& at,
                                      const foveation::Display& display, std::size_t eye);
  /// The second layer of an eye, made once a frame; null where it has none.
  const reprojection::HiddenPicture* hidden_of(const frames::DecodedFrame& frame, std::size_t eye);

  const reprojection::WarpOptions options_;
  const Depth depth_;
  On on_;
  const Eyes at_once_;
  WarpedEyes eyes_;
  struct Hidden {
    std::optional<frames::FrameId> of;
    std::optional<reprojection::HiddenPicture> picture;
  };
  std::vector<reprojection::Warper> warpers_;  ///< by eye
  std::vector<Hidden> hidden_;                 ///< by eye
  struct Pass {
    std::unique_ptr<display::WarpPass> pass;
    std::optional<frames::FrameId> holds;
  };
  std::vector<Pass> passes_;  ///< by eye; of On::Gl
};

}  // namespace macula::client_app
