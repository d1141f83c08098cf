// Whether the motion in a scene keeps the promises of motion.h.
#include <algorithm>
#include <cmath>
#include <string_view>

#include "server/scene/animation.h"
#include "shared/base/text.h"

namespace macula::scene {
namespace {

using base::bad_input;

bool finite(const Vec3& v) {
  return math::is_finite(v);
}
bool finite(const DVec3& v) {
  return math::is_finite(v);
}
bool finite(const DQuat& q) {
  return std::isfinite(q.w) && std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z);
}
bool finite(const DMat4& m) {
  for (int column = 0; column < 4; ++column)
    if (!math::is_finite(DVec3(m[column])) || !std::isfinite(m[column].w)) return false;
  return true;
}

bool rises(const std::vector<double>& times_s) {
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    if (!std::isfinite(times_s[i]) || (i > 0 && !(times_s[i] > times_s[i - 1]))) return false;
  }
  return true;
}

template <class Values>
bool all_finite(const Values& values) {
  for (const auto& value : values)
    if (!finite(value)) return false;
  return true;
}

/// Quaternions at keys have a direction; tangents may be zero.
bool usable(const Track<DVec3>&) {
  return true;
}
bool usable(const Track<DQuat>& track) {
  const bool spline = track.interpolation == Interpolation::CubicSpline;
  for (std::size_t i = spline ? 1 : 0; i < track.values.size(); i += spline ? 3 : 1)
    if (!(glm::length(track.values[i]) > 0.0)) return false;
  return true;
}

template <class Value>
Result<void> check_track(const Track<Value>& track, const std::string& where) {
  if (!rises(track.times_s))
    return bad_input("the keys' times do not rise", where, "finite, strictly increasing seconds");
  const std::size_t each = track.interpolation == Interpolation::CubicSpline ? 3 : 1;
  if (track.values.size() != each * track.times_s.size())
    return bad_input(
        base::concat(track.values.size(), " values for ", track.times_s.size(), " keys"), where,
        "one a key, three for a cubic spline");
  if (!all_finite(track.values) || !usable(track))
    return bad_input("a key's value is not usable", where,
                     "finite numbers, quaternions other than 0");
  return {};
}

Result<void> check_joint(const Scene& scene, std::size_t index) {
  const Joint& joint = scene.joints[index];
  const std::string where = base::concat(scene.name, ", joint ", index, " '", joint.name, "'");
  if (joint.parent && *joint.parent >= index)
    return bad_input(base::concat("its parent is ", *joint.parent), where,
                     "a joint before it in the table");
  if (!finite(joint.parent_from_base) || !finite(joint.translation) || !finite(joint.rotation) ||
      !finite(joint.scale) || !(glm::length(joint.rotation) > 0.0))
    return bad_input("its rest transform is not usable", where,
                     "finite numbers and a rotation other than 0");
  if (joint.period < Nanoseconds::zero())
    return bad_input("its period is negative", where, "0 or more nanoseconds");
  if (auto good = check_track(joint.translations, where + ", translation"); !good) return good;
  if (auto good = check_track(joint.rotations, where + ", rotation"); !good) return good;
  return check_track(joint.scales, where + ", scale");
}

bool all_have(const std::vector<std::vector<Vec3>>& keys, std::size_t vertices) {
  for (const auto& key : keys)
    if (key.size() != vertices || !all_finite(key)) return false;
  return true;
}

Result<void> check_deformation(const Mesh& mesh, const std::string& where) {
  const Deformation& deformation = mesh.deformation;
  const std::size_t keys = deformation.times_s.size();
  if (!rises(deformation.times_s))
    return bad_input("the keys' times do not rise", where, "finite, strictly increasing seconds");
  const std::size_t normal_keys = mesh.normals.empty() ? 0 : keys;
  if (deformation.positions.size() != keys || deformation.normals.size() != normal_keys ||
      !all_have(deformation.positions, mesh.positions.size()) ||
      !all_have(deformation.normals, mesh.normals.size()))
    return bad_input("a key does not fit the mesh", where,
                     "finite positions, and normals where the mesh has them, as many as its own");
  if (deformation.period < Nanoseconds::zero())
    return bad_input("its period is negative", where, "0 or more nanoseconds");
  return {};
}

template <class Part>
Result<void> check_carried(const Scene& scene, const std::vector<Part>& parts,
                           std::string_view what) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].joint && *parts[i].joint >= scene.joints.size())
      return bad_input(base::concat("there is no joint ", *parts[i].joint),
                       base::concat(scene.name, ", ", what, " ", i),
                       base::concat("there are ", scene.joints.size()));
  }
  return {};
}

// ---- how far motion leads ----

/// A bound on |value(t)| at all times. The weights of a cubic Hermite spline's values sum to 1,
/// those of its two tangents reach 4/27 of the step between keys.
double most_of(const Track<DVec3>& track, const DVec3& at_rest) {
  if (track.empty()) return glm::length(at_rest);
  double most = 0.0;
  if (track.interpolation != Interpolation::CubicSpline) {
    for (const DVec3& value : track.values) most = std::max(most, glm::length(value));
    return most;
  }
  double tangent = 0.0, step = 0.0;
  for (std::size_t key = 0; key < track.times_s.size(); ++key) {
    const DVec3* values = &track.values[3 * key];
    most = std::max(most, glm::length(values[1]));
    tangent = std::max({tangent, glm::length(values[0]), glm::length(values[2])});
    if (key > 0) step = std::max(step, track.times_s[key] - track.times_s[key - 1]);
  }
  return most + 2.0 * 4.0 / 27.0 * step * tangent;
}
/// The same of the largest component: the most that a scale stretches.
double most_scale_of(const Joint& joint) {
  const auto largest = [](const DVec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  };
  const Track<DVec3>& track = joint.scales;
  if (track.interpolation == Interpolation::CubicSpline) return most_of(track, joint.scale);
  double most = track.empty() ? largest(joint.scale) : 0.0;
  for (const DVec3& value : track.values) most = std::max(most, largest(value));
  return most;
}

double longest(const std::vector<Vec3>& positions) {
  float most2 = 0.0F;
  for (const Vec3& position : positions) most2 = std::max(most2, glm::dot(position, position));
  return std::sqrt(static_cast<double>(most2));
}
double longest(const Mesh& mesh) {
  double most = longest(mesh.positions);
  for (const auto& key : mesh.deformation.positions) most = std::max(most, longest(key));
  return most;
}

/// The most that a vector grows: the root of the largest eigenvalue of m^T m, which is q + 2 p
/// cos(acos(r) / 3) (Smith 1961, "Eigenvalues of a symmetric 3 x 3 matrix").
double largest_stretch(const DMat3& m) {
  const DMat3 square = glm::transpose(m) * m;
  const double q = (square[0][0] + square[1][1] + square[2][2]) / 3.0;
  const DMat3 rest = square - DMat3(q);
  double sum = 0.0;
  for (int column = 0; column < 3; ++column) sum += glm::dot(rest[column], rest[column]);
  const double p = std::sqrt(sum / 6.0);
  if (!(p > 0.0)) return std::sqrt(q);
  const double r = std::clamp(glm::determinant(rest / p) / 2.0, -1.0, 1.0);
  return std::sqrt(q + 2.0 * p * std::cos(std::acos(r) / 3.0));
}
/// A bound on the distance from the origin of a point that was `reach` from it before.
double moved_reach(const DMat4& transform, double reach) {
  return glm::length(DVec3(transform[3])) + largest_stretch(DMat3(transform)) * reach;
}
double carried_reach(const Scene& scene, std::optional<Index> joint, double reach) {
  while (joint) {
    const Joint& carrier = scene.joints[*joint];
    reach = most_of(carrier.translations, carrier.translation) + most_scale_of(carrier) * reach;
    reach = moved_reach(carrier.parent_from_base, reach);
    joint = carrier.parent;
  }
  return reach;
}

}  // namespace

double farthest_reach_m(const Scene& scene) {
  std::vector<double> lengths;
  for (const Mesh& mesh : scene.meshes) lengths.push_back(longest(mesh));
  double farthest = 0.0;
  for (const Instance& instance : scene.instances) {
    const double own = moved_reach(instance.parent_from_object, lengths[instance.mesh]);
    farthest = std::max(farthest, carried_reach(scene, instance.joint, own));
  }
  for (const Light& light : scene.lights)
    farthest = std::max(farthest, carried_reach(scene, light.joint, glm::length(light.position)));
  for (const Camera& camera : scene.cameras) {
    const double own = glm::length(camera.parent_from_view.position);
    farthest = std::max(farthest, carried_reach(scene, camera.joint, own));
  }
  return farthest;
}

Result<void> check_motion(const Scene& scene) {
  for (std::size_t i = 0; i < scene.joints.size(); ++i)
    if (auto good = check_joint(scene, i); !good) return good;
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    if (scene.meshes[i].deformation.empty()) continue;
    const std::string where =
        base::concat(scene.name, ", mesh ", i, " '", scene.meshes[i].name, "'");
    if (auto good = check_deformation(scene.meshes[i], where); !good) return good;
  }
  if (auto good = check_carried(scene, scene.instances, "instance"); !good) return good;
  if (auto good = check_carried(scene, scene.lights, "light"); !good) return good;
  return check_carried(scene, scene.cameras, "camera");
}

}  // namespace macula::scene
