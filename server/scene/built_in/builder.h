// SceneBuilder: fills a Scene's tables and hands out their indices, so that a generator reads as a
// list of things and places. Transforms read world_from_object, in meters.
#pragma once

#include <string>
#include <utility>

#include "server/scene/scene.h"

namespace macula::scene::built_in {

DMat4 translation(const DVec3& offset);
DMat4 rotation_y(Radians angle);
DMat4 rotation_x(Radians angle);
DMat4 rotation_z(Radians angle);
DMat4 scaling(const DVec3& factors);

/// Pure Lambert: no specular lobe at all.
Material lambert(std::string name, const Rgb& base_color);
/// The Lambertian white that a texture multiplies.
Material textured(std::string name, Index image);
/// Polished: a 4 % specular lobe of this perceptual roughness over the diffuse colour.
Material glossy(Material material, float roughness);
Material metal(std::string name, const Rgb& base_color, float roughness);
/// Radiates on its front side only.
Material lamp(std::string name, const Rgb& radiance);

class SceneBuilder {
 public:
  explicit SceneBuilder(std::string name) { scene_.name = std::move(name); }

  Index add(Image image);
  Index add(Material material);
  /// Under `material`, whatever the mesh said before.
  Index add(Mesh mesh, Index material);
  void place(Index mesh, const DMat4& world_from_object = DMat4{1.0});
  void place(Mesh mesh, Index material, const DMat4& world_from_object = DMat4{1.0});
  Index add(Joint joint);
  /// Carried by a joint.
  void hang(Index joint, Index mesh, const DMat4& joint_from_object = DMat4{1.0});
  void add(const Light& light) { scene_.lights.push_back(light); }
  void add(Camera camera) { scene_.cameras.push_back(std::move(camera)); }
  Settings& settings() { return scene_.settings; }

  Scene finish() && { return std::move(scene_); }

 private:
  Scene scene_;
};

}  // namespace macula::scene::built_in
