#include "client/app/eye_rig.h"

#include <cmath>

#include "shared/base/check.h"
#include "shared/math/frames.h"

namespace macula::client_app {

EyeRig EyeRig::side_by_side(const foveation::Display& display, int eyes, Meters ipd,
                            Meters convergence) {
  MACULA_CHECK(eyes == 1 || eyes == 2);
  const double half_m = eyes == 1 ? 0.0 : 0.5 * ipd.value();
  EyeRig rig{{{Pose{DVec3{-half_m, 0.0, 0.0}}, display}}, convergence};
  if (eyes == 2) rig.eyes.push_back({Pose{DVec3{half_m, 0.0, 0.0}}, display});
  return rig;
}

Gaze EyeRig::gaze_of(std::size_t eye, const Gaze& head_gaze) const {
  MACULA_CHECK(eye < eyes.size(), "no such eye");
  const DVec3 target = convergence.value() * glm::normalize(DVec3(head_gaze.direction));
  const DVec3 from_eye = math::inverse(eyes[eye].head_from_eye).transform_point(target);
  return {Vec3(glm::normalize(from_eye)), head_gaze.valid, head_gaze.confidence};
}

Vec3 EyeRig::head_gaze_through(std::size_t eye, const DVec2& tangent) const {
  MACULA_CHECK(eye < eyes.size(), "no such eye");
  const Pose& head_from_eye = eyes[eye].head_from_eye;
  const DVec3 sight = head_from_eye.transform_direction(math::direction_from_tangent(tangent));
  // Where the sight meets the sphere of radius `convergence` around the head.
  const DVec3 unit = glm::normalize(sight);
  const double along = glm::dot(unit, head_from_eye.position);
  const double radius = convergence.value();
  const double offset2 = glm::dot(head_from_eye.position, head_from_eye.position);
  const double reach = -along + std::sqrt(along * along + radius * radius - offset2);
  return Vec3(glm::normalize(head_from_eye.position + reach * unit));
}

net::ViewState EyeRig::view_state(const Pose& stage_from_head, const Gaze& head_gaze) const {
  net::ViewState view;
  view.stage_from_head = stage_from_head;
  for (std::size_t eye = 0; eye < eyes.size(); ++eye) {
    view.eyes.push_back({eyes[eye].head_from_eye, eyes[eye].display.fov, gaze_of(eye, head_gaze)});
  }
  return view;
}

}  // namespace macula::client_app
