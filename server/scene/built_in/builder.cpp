#include "server/scene/built_in/builder.h"

namespace macula::scene::built_in {

DMat4 translation(const DVec3& offset) {
  return glm::translate(DMat4{1.0}, offset);
}
DMat4 rotation_x(Radians angle) {
  return glm::rotate(DMat4{1.0}, angle.value(), DVec3{1, 0, 0});
}
DMat4 rotation_y(Radians angle) {
  return glm::rotate(DMat4{1.0}, angle.value(), DVec3{0, 1, 0});
}
DMat4 rotation_z(Radians angle) {
  return glm::rotate(DMat4{1.0}, angle.value(), DVec3{0, 0, 1});
}
DMat4 scaling(const DVec3& factors) {
  return glm::scale(DMat4{1.0}, factors);
}

Material lambert(std::string name, const Rgb& base_color) {
  Material material;
  material.name = std::move(name);
  material.base_color = base_color;
  material.specular = 0.0F;
  return material;
}

Material textured(std::string name, Index image) {
  Material material = lambert(std::move(name), Rgb{1.0F});
  material.base_color_texture = TextureRef{.image = image};
  return material;
}

Material glossy(Material material, float roughness) {
  material.specular = 1.0F;
  material.roughness = roughness;
  return material;
}

Material metal(std::string name, const Rgb& base_color, float roughness) {
  Material material = lambert(std::move(name), base_color);
  material.specular = 1.0F;
  material.metallic = 1.0F;
  material.roughness = roughness;
  return material;
}

Material lamp(std::string name, const Rgb& radiance) {
  Material material = lambert(std::move(name), Rgb{0.0F});
  material.emission = radiance;
  return material;
}

Index SceneBuilder::add(Image image) {
  scene_.images.push_back(std::move(image));
  return static_cast<Index>(scene_.images.size() - 1);
}

Index SceneBuilder::add(Material material) {
  scene_.materials.push_back(std::move(material));
  return static_cast<Index>(scene_.materials.size() - 1);
}

Index SceneBuilder::add(Mesh mesh, Index material) {
  mesh.material = material;
  scene_.meshes.push_back(std::move(mesh));
  return static_cast<Index>(scene_.meshes.size() - 1);
}

void SceneBuilder::place(Index mesh, const DMat4& world_from_object) {
  scene_.instances.push_back({mesh, world_from_object});
}

void SceneBuilder::place(Mesh mesh, Index material, const DMat4& world_from_object) {
  place(add(std::move(mesh), material), world_from_object);
}

Index SceneBuilder::add(Joint joint) {
  scene_.joints.push_back(std::move(joint));
  return static_cast<Index>(scene_.joints.size() - 1);
}

void SceneBuilder::hang(Index joint, Index mesh, const DMat4& joint_from_object) {
  scene_.instances.push_back({mesh, joint_from_object, joint});
}

}  // namespace macula::scene::built_in
