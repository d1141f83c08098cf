// EyeGaze: the eye tracker behind XR_EXT_eye_gaze_interaction, as an action of its own. Internal to
// this room.
#pragma once

#include <memory>
#include <optional>

#include "client/display/openxr/runtime.h"
#include "shared/math/vec.h"

namespace macula::display {

class EyeGaze {
 public:
  struct Sample {
    Vec3 direction;  ///< unit, in the head frame
    ClientTime at;   ///< when the tracker took it
  };

  /// Before anything else attaches actions to the session. The person may still deny the tracker.
  static Result<std::unique_ptr<EyeGaze>> create(const Runtime& runtime, XrSession session);
  ~EyeGaze();
  EyeGaze(const EyeGaze&) = delete;
  EyeGaze& operator=(const EyeGaze&) = delete;

  /// The tracker's word for `at`, seen from `head`; nullopt: it has none, as during a blink.
  std::optional<Sample> sample(XrSpace head, ClientTime at);

 private:
  EyeGaze(const Runtime& runtime, XrSession session) : runtime_(runtime), session_(session) {}
  Result<void> make_action();
  Result<void> bind();
  bool is_active();

  const Runtime& runtime_;
  const XrSession session_;
  XrActionSet set_ = XR_NULL_HANDLE;
  XrAction action_ = XR_NULL_HANDLE;
  XrSpace space_ = XR_NULL_HANDLE;
};

}  // namespace macula::display
