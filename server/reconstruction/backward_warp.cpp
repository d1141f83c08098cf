#include "server/reconstruction/backward_warp.h"

#include <cmath>

#include "shared/math/frames.h"

namespace macula::reconstruction {

BackwardWarp::BackwardWarp(const Pose& world_from_now, const Pose& world_from_then,
                           const PixelGrid& grid_then)
    : then_from_now_rotation_(1.0F), then_from_now_origin_(0.0F), grid_(grid_then) {
  const Pose then_from_now = math::inverse(world_from_then) * world_from_now;
  then_from_now_rotation_ = Mat3(glm::mat3_cast(then_from_now.rotation));
  then_from_now_origin_ = Vec3(then_from_now.position);
}

std::optional<BackwardWarp::Place> BackwardWarp::then(const Vec2& tangent, float depth_m) const {
  const Vec3 direction = then_from_now_rotation_ * math::direction_from_tangent(tangent);
  const bool far = std::isinf(depth_m);
  const Vec3 point = far ? direction : then_from_now_origin_ + depth_m * direction;
  const auto cell = grid_.project(point);
  if (!cell) return std::nullopt;
  return Place{*cell, far ? depth_m : -point.z};
}

float BackwardWarp::depth_now(const Vec2& tangent_then, float depth_then_m) const {
  if (std::isinf(depth_then_m)) return depth_then_m;
  const Vec3 point = depth_then_m * math::direction_from_tangent(tangent_then);
  const Vec3 seen = point - then_from_now_origin_;
  return -glm::dot(then_from_now_rotation_[2], seen);  // third row of the inverse rotation
}

}  // namespace macula::reconstruction
