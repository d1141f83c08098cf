// LateStart: when a refresh's work begins, so that it is done just in time: the frame fetched then
// and the head sampled then are the newest the display can have. By how long the last warps took, a
// quarter more, and a margin of two milliseconds that every missed light widens by two more and
// that narrows again over a thousand refreshes. Pure; one thread.
#pragma once

#include "shared/units/time.h"

namespace macula::client_app {

class LateStart {
 public:
  static constexpr double kLeastMargin_ms = 2.0;  ///< of waking up and handing over

  explicit LateStart(Nanoseconds period) : period_(period) {}

  /// From beginning to the light; a whole period until a warp is known.
  Nanoseconds lead() const;
  /// One refresh: what fetching and warping took, and how long after its time it lit up.
  void note(Nanoseconds work, Nanoseconds late);

 private:
  Nanoseconds period_;
  Nanoseconds work_{-1};  ///< the longest lately; negative: none is known
  double margin_ms_ = kLeastMargin_ms;
};

}  // namespace macula::client_app
