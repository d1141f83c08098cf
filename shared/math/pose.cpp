#include "shared/math/pose.h"

#include <cmath>

namespace macula::math {

Pose operator*(const Pose& a_from_b, const Pose& b_from_c) {
  return {a_from_b.transform_point(b_from_c.position),
          glm::normalize(a_from_b.rotation * b_from_c.rotation)};
}

Pose inverse(const Pose& a_from_b) {
  const DQuat b_from_a = glm::conjugate(a_from_b.rotation);
  return {b_from_a * -a_from_b.position, b_from_a};
}

Pose interpolate(const Pose& a, const Pose& b, double t) {
  return {a.position + t * (b.position - a.position),
          glm::normalize(glm::slerp(a.rotation, b.rotation, t))};
}

Radians angle_between(const Pose& a, const Pose& b) {
  const DQuat difference = glm::conjugate(a.rotation) * b.rotation;
  const double sine = std::sqrt(difference.x * difference.x + difference.y * difference.y +
                                difference.z * difference.z);
  return Radians{2.0 * std::atan2(sine, std::abs(difference.w))};
}

Pose look_at(const DVec3& eye, const DVec3& target, const DVec3& up) {
  const DVec3 back = glm::normalize(eye - target);
  const DVec3 right = glm::normalize(glm::cross(up, back));
  const DVec3 true_up = glm::cross(back, right);
  return {eye, glm::normalize(glm::quat_cast(DMat3(right, true_up, back)))};
}

bool is_valid(const Pose& pose) {
  constexpr double kFarthest_m = 1e7;
  constexpr double kUnitTolerance = 1e-3;
  const DQuat& q = pose.rotation;
  if (!is_finite(pose.position) || !is_finite(DVec3(q.x, q.y, q.z)) || !std::isfinite(q.w)) {
    return false;
  }
  return glm::length(pose.position) < kFarthest_m &&
         std::abs(glm::length(q) - 1.0) < kUnitTolerance;
}

}  // namespace macula::math
