#include "client/pose/interactive_source.h"

#include <algorithm>

#include "shared/math/frames.h"

namespace macula::pose {
namespace {

constexpr Degrees kSteepestPitch{85.0};
const DVec3 kUp{0.0, 1.0, 0.0};

DQuat heading(Radians yaw) {
  return glm::angleAxis(yaw.value(), kUp);
}

}  // namespace

void InteractiveSource::steer(const Steering& steering) {
  if (steering.reset == Steering::Reset::Yes) *this = InteractiveSource{};
  yaw_ = yaw_ + steering.turn_left;
  const Radians steepest{kSteepestPitch};
  pitch_ = std::clamp(pitch_ + steering.turn_up, -steepest, steepest);
  position_m_ += heading(yaw_) * steering.move_m;
  gaze_.valid = steering.gaze_tangent.has_value();
  if (steering.gaze_tangent) {
    gaze_.direction = Vec3(glm::normalize(math::direction_from_tangent(*steering.gaze_tangent)));
  }
}

std::optional<HeadSample> InteractiveSource::sample(ClientTime at) {
  const DQuat pitch = glm::angleAxis(pitch_.value(), DVec3{1.0, 0.0, 0.0});
  return HeadSample{at, Pose{position_m_, glm::normalize(heading(yaw_) * pitch)}, gaze_, at};
}

}  // namespace macula::pose
