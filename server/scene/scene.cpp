#include "server/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <numbers>
#include <sstream>

#include "server/scene/animation.h"
#include "server/sdf/field.h"
#include "shared/base/text.h"

namespace macula::scene {

void Bounds::include(const DVec3& point) {
  for (int axis = 0; axis < 3; ++axis) {
    minimum[axis] = std::min(minimum[axis], point[axis]);
    maximum[axis] = std::max(maximum[axis], point[axis]);
  }
}

Rgb Environment::mean() const {
  DVec3 sum{0.0};
  double weight = 0.0;
  for (int y = 0; y < radiance.height(); ++y) {
    const double share = std::sin(std::numbers::pi * (y + 0.5) / radiance.height());
    for (const Rgb& value : radiance.row(y)) sum += share * DVec3(value), weight += share;
  }
  return Rgb(static_cast<double>(scale) * sum / weight);
}

std::size_t Scene::triangle_count() const {
  std::size_t count = 0;
  for (const Instance& instance : instances) count += meshes[instance.mesh].triangles.size();
  return count;
}

std::size_t Scene::emissive_triangle_count() const {
  std::size_t count = 0;
  for (const Instance& instance : instances) {
    const Mesh& mesh = meshes[instance.mesh];
    if (materials[mesh.material].emits()) count += mesh.triangles.size();
  }
  return count;
}

std::size_t Scene::unique_triangle_count() const {
  std::size_t count = 0;
  for (const Mesh& mesh : meshes) count += mesh.triangles.size();
  return count;
}

Bounds Scene::bounds(SceneTime time) const {
  Bounds bounds;
  const ScenePose pose = pose_at(*this, time);
  for (std::size_t i = 0; i < instances.size(); ++i) {
    for (const Vec3& position : pose.positions(*this, instances[i].mesh)) {
      bounds.include(DVec3(pose.world_from_object[i] * DVec4(DVec3(position), 1.0)));
    }
  }
  return bounds;
}

std::string describe(const Scene& scene) {
  if (scene.field != nullptr) {
    return base::concat("a distance field of ", scene.field->nodes.size(), " nodes, ",
                        scene.lights.size(), " lights, ", scene.materials.size(), " materials");
  }
  const DVec3 size = scene.bounds().size();
  std::ostringstream text;
  text << scene.triangle_count() << " triangles (" << scene.unique_triangle_count() << " unique, "
       << scene.emissive_triangle_count() << " emissive), " << scene.lights.size() << " lights, "
       << scene.materials.size() << " materials, " << scene.images.size() << " textures, "
       << std::fixed << std::setprecision(1) << size.x << " x " << size.y << " x " << size.z
       << " m";
  return std::move(text).str();
}

}  // namespace macula::scene
