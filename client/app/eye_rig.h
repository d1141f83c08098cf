// EyeRig: from a head to its eyes. Each eye has a place and a display of its own; their gazes
// converge on the point `convergence` along the head's gaze, so each eye's foveal region lands on
// the same thing. A value.
#pragma once

#include <vector>

#include "client/pose/pose_source.h"
#include "shared/foveation/pixel_grid.h"
#include "shared/net/messages.h"
#include "shared/units/length.h"

namespace macula::client_app {

struct EyeRig {
  struct Eye {
    Pose head_from_eye;
    foveation::Display display;
  };
  std::vector<Eye> eyes;  ///< left first
  Meters convergence{1.0};

  /// Eyes that look straight ahead, half the interpupillary distance left and right of the head's
  /// origin; a single eye sits at the origin.
  static EyeRig side_by_side(const foveation::Display& display, int eyes, Meters ipd,
                             Meters convergence);
  /// The head's gaze seen from one eye.
  Gaze gaze_of(std::size_t eye, const Gaze& head_gaze) const;
  /// The reverse: the head's gaze when one eye looks through a point of its tangent plane.
  Vec3 head_gaze_through(std::size_t eye, const DVec2& tangent) const;
  /// Stamps are the caller's: only poses, fields of view and gazes are set.
  net::ViewState view_state(const Pose& stage_from_head, const Gaze& head_gaze) const;
};

}  // namespace macula::client_app
