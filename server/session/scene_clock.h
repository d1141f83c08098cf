// SceneClock: the scene's time, one for all sessions: whole ticks since the server's start, so that
// sessions whose frames begin in the same tick share a SceneFrame. A value; time is an argument.
#pragma once

#include "server/scene/motion.h"
#include "shared/units/time.h"

namespace macula::session {

class SceneClock {
 public:
  /// Far below a display's refresh: motion stays smooth.
  static constexpr Nanoseconds kTick = std::chrono::milliseconds{4};

  /// The scene's time is 0 at `start`.
  explicit SceneClock(ServerTime start) : start_(start) {}

  scene::SceneTime at(ServerTime now) const {
    const Nanoseconds since = now - start_;
    return {since.count() > 0 ? since / kTick * kTick : Nanoseconds{0}};
  }

 private:
  ServerTime start_;
};

}  // namespace macula::session
