// EyeRig: from a head to its eyes. The eyes sit half the interpupillary distance left and right of
// the head's origin and look straight ahead; their gazes converge on the point `convergence` along
// the head's gaze, so each eye's foveal region lands on the same thing. A value.
#pragma once

#include <cstdint>

#include "client/pose/pose_source.h"
#include "shared/foveation/pixel_grid.h"
#include "shared/net/messages.h"
#include "shared/units/length.h"

namespace macula::client_app {

struct EyeRig {
  foveation::Display display;
  int eyes = 2;  ///< 1: a single eye at the head's origin
  Meters ipd{0.063};
  Meters convergence{1.0};

  /// Left is 0.
  Pose head_from_eye(int eye) const;
  /// The head's gaze seen from one eye.
  Gaze gaze_of(int eye, const Gaze& head_gaze) const;
  /// The reverse: the head's gaze when one eye looks through a point of its tangent plane.
  Vec3 head_gaze_through(int eye, const DVec2& tangent) const;
  /// Stamps are the caller's: only poses, fields of view and gazes are set.
  net::ViewState view_state(const Pose& stage_from_head, const Gaze& head_gaze) const;
};

}  // namespace macula::client_app
