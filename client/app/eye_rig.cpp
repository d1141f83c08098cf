#include "client/app/eye_rig.h"

#include <cmath>

#include "shared/base/check.h"
#include "shared/math/frames.h"

namespace macula::client_app {

Pose EyeRig::head_from_eye(int eye) const {
  MACULA_CHECK(eye >= 0 && eye < eyes, "no such eye");
  if (eyes == 1) return Pose{};
  return Pose{DVec3{(eye == 0 ? -0.5 : 0.5) * ipd.value(), 0.0, 0.0}};
}

Gaze EyeRig::gaze_of(int eye, const Gaze& head_gaze) const {
  const DVec3 target = convergence.value() * glm::normalize(DVec3(head_gaze.direction));
  const DVec3 from_eye = math::inverse(head_from_eye(eye)).transform_point(target);
  return {Vec3(glm::normalize(from_eye)), head_gaze.valid, head_gaze.confidence};
}

Vec3 EyeRig::head_gaze_through(int eye, const DVec2& tangent) const {
  const Pose eye_pose = head_from_eye(eye);
  const DVec3 sight = eye_pose.transform_direction(math::direction_from_tangent(tangent));
  // Where the sight meets the sphere of radius `convergence` around the head.
  const DVec3 unit = glm::normalize(sight);
  const double along = glm::dot(unit, eye_pose.position);
  const double radius = convergence.value();
  const double offset2 = glm::dot(eye_pose.position, eye_pose.position);
  const double reach = -along + std::sqrt(along * along + radius * radius - offset2);
  return Vec3(glm::normalize(eye_pose.position + reach * unit));
}

net::ViewState EyeRig::view_state(const Pose& stage_from_head, const Gaze& head_gaze) const {
  net::ViewState view;
  view.stage_from_head = stage_from_head;
  for (int eye = 0; eye < eyes; ++eye) {
    view.eyes.push_back({head_from_eye(eye), display.fov, gaze_of(eye, head_gaze)});
  }
  return view;
}

}  // namespace macula::client_app
