// Vectors, quaternions and matrices: glm under our own names; glm's functions are found by ADL.
// Vec* are float (directions, camera-relative positions, colours), DVec* double (world positions).
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_inverse.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace macula::math {

using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using DVec2 = glm::dvec2;
using DVec3 = glm::dvec3;
using DVec4 = glm::dvec4;
using UVec3 = glm::uvec3;
using Mat3 = glm::mat3;
using Mat4 = glm::mat4;
using DMat3 = glm::dmat3;
using DMat4 = glm::dmat4;
using DQuat = glm::dquat;  ///< constructor order (w, x, y, z)

inline bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
inline bool is_finite(const DVec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace macula::math

namespace macula {
using math::DMat3;
using math::DMat4;
using math::DQuat;
using math::DVec2;
using math::DVec3;
using math::DVec4;
using math::Mat3;
using math::Mat4;
using math::UVec3;
using math::Vec2;
using math::Vec3;
using math::Vec4;
}  // namespace macula
