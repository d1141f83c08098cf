// The figures a session lives by, in one place. Production uses the defaults; tests may tighten
// them.
#pragma once

#include <cstddef>

#include "server/session/governor.h"
#include "shared/foveation/gaze_follower.h"
#include "shared/units/angle.h"
#include "shared/units/time.h"

namespace macula::session {

struct SessionRules {
  /// Without a newer ViewState for this long nothing is rendered for the client.
  Nanoseconds stop_rendering_after{std::chrono::milliseconds{500}};
  /// Without a ViewState for this long the session is freed.
  Nanoseconds free_after{std::chrono::seconds{3}};
  /// A sent frame without any receiving progress for max(this, loss_timeout_rtts x RTT) is lost.
  Nanoseconds least_loss_timeout{std::chrono::seconds{1}};
  int loss_timeout_rtts = 4;
  /// A frame's pose is predicted at most this far ahead; 0: poses are rendered as they come.
  Nanoseconds longest_horizon{0};
  /// What a fast head may ask for beyond the configured guard band; 0: nothing.
  Degrees most_guard_band{0.0};
  /// A second layer is made for eyes that move at most so far until a frame is seen; 0: none is.
  double most_view_cell_m = 0.0;
  Goals goals;  ///< what frames may cost and how old they may be shown
  foveation::GazeFollowerOptions gaze;
  /// Where frames lean on each other, a grid rests until the gaze is so far from its centre.
  Degrees grid_rest{2.0};
  /// Bounds of the credit window, in frames.
  int least_window = 2, most_window = 6;
  /// Frames of one session between their start and their first byte: one renders while one encodes.
  int most_unsent = 2;
  /// Sessions at once; the next Hello is refused as ServerFull.
  std::size_t most_sessions = 8;
  /// A client that keeps acknowledging another epoch has missed its Welcome: it hears it again at
  /// most this often.
  Nanoseconds welcome_interval{std::chrono::milliseconds{200}};
  /// One unknown peer hears UnknownSession at most this often.
  Nanoseconds refusal_interval{std::chrono::milliseconds{100}};
};

}  // namespace macula::session
