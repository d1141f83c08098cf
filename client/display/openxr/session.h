// Session: the runtime's permission to show something: its life, its spaces and its frames.
// Internal to this room.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "client/display/openxr/headset.h"
#include "client/display/openxr/runtime.h"

namespace macula::display {

class Session {
 public:
  /// Binds the GLX context that is current.
  static Result<std::unique_ptr<Session>> create(const Runtime& runtime);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  XrSession handle() const { return session_; }
  XrSpace stage() const { return stage_; }
  XrSpace head() const { return head_; }

  HeadsetState poll();
  std::optional<HeadsetFrame> begin_frame();
  /// Of the frame that was begun.
  void end_frame(std::span<const XrCompositionLayerBaseHeader* const> layers);
  std::optional<Pose> stage_from_head(ClientTime at);
  std::optional<HeadsetEyes> eyes(ClientTime at);
  /// After it poll() comes to Closed.
  void request_exit();

 private:
  explicit Session(const Runtime& runtime) : runtime_(runtime) {}
  Result<void> open();
  Result<void> make_spaces();
  void take(const XrEventDataBuffer& event);
  void enter(XrSessionState state);
  /// Notes whether the call says that the runtime is gone; whether it succeeded.
  bool succeeded(XrResult result);

  const Runtime& runtime_;
  XrSession session_ = XR_NULL_HANDLE;
  XrSpace stage_ = XR_NULL_HANDLE, head_ = XR_NULL_HANDLE;
  HeadsetState state_ = HeadsetState::Idle;
  XrTime display_ = 0;  ///< of the frame begun, in the runtime's own count
};

}  // namespace macula::display
