// InteractiveSource: head and gaze from a desktop. The cursor is the gaze, dragging turns the head,
// keys move it level with the floor. Starts at the stage's origin, eyes 1.6 m up. One thread.
#pragma once

#include <optional>

#include "client/pose/pose_source.h"
#include "shared/units/angle.h"

namespace macula::pose {

/// What happened since the last call, in the head's own terms; the window's units stay outside.
struct Steering {
  /// Cursor on the view's tangent plane (frames.h, y down); nullopt when it is not over the
  /// picture.
  std::optional<DVec2> gaze_tangent;
  Radians turn_left, turn_up;  ///< to add to yaw and pitch
  DVec3 move_m{0.0};           ///< right, up, backwards, along the heading
  enum class Reset { No, Yes };
  Reset reset = Reset::No;  ///< back to the start
};

class InteractiveSource final : public PoseSource {
 public:
  void steer(const Steering& steering);
  /// Never ends.
  std::optional<HeadSample> sample(ClientTime at) override;

 private:
  static constexpr DVec3 kStart_m{0.0, 1.6, 0.0};
  DVec3 position_m_ = kStart_m;
  Radians yaw_, pitch_;
  Gaze gaze_;
};

}  // namespace macula::pose
