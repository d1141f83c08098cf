// Small scenes that need little, each another part of a plan.
#pragma once

#include <utility>

#include "tests/conformance/test_scenes.h"

namespace macula::test {

/// A Lambertian floor and ball under one lamp: what needs least.
inline scene::Scene bare() {
  scene::Scene scene;
  scene.name = "bare";
  scene.materials.resize(1);
  scene.materials[0].specular = 0.0F;
  add_quad(scene, {-2, -1, 0}, {4, 0, 0}, {0, 0, -5}, 0);
  add_sphere(scene, {0, -0.3F, -3}, 0.7F, 8, 0);
  scene::Light light;
  light.intensity = Rgb{8.0F};
  light.position = {1.0, 2.0, -2.0};
  scene.lights = {light};
  return scene;
}

/// A chequer of colours, every other texel with half and with no alpha.
inline scene::Image chequer() {
  scene::Image image;
  image.pixels = image::Plane<image::Rgba8>(8, 8);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      const bool odd = (x + y) % 2 != 0;
      image.pixels(x, y) = {static_cast<std::uint8_t>(30 * x), 200,
                            odd ? std::uint8_t{20} : std::uint8_t{220},
                            static_cast<std::uint8_t>(odd ? 0 : 255)};
    }
  }
  return image;
}

inline scene::Scene textured() {
  scene::Scene scene = bare();
  scene.images = {chequer()};
  scene.materials[0].base_color_texture = scene::TextureRef{};
  return scene;
}

inline scene::Scene masked() {
  scene::Scene scene = textured();
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].alpha_mode = scene::AlphaMode::Mask;
  add_quad(scene, {-1, -0.8F, -1.5F}, {2, 0, 0}, {0, 1.2F, 0}, 1);
  return scene;
}

inline scene::Scene metallic() {
  scene::Scene scene = bare();
  scene.materials[0].specular = 1.0F;
  scene.materials[0].metallic = 1.0F;
  scene.materials[0].roughness = 0.5F;
  return scene;
}

/// Lit by a panel alone.
inline scene::Scene panel() {
  scene::Scene scene = bare();
  scene.lights.clear();
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].emission = Rgb{5.0F, 4.0F, 3.0F};
  add_quad(scene, {-0.7F, 1.5F, -3.2F}, {0.8F, 0, 0}, {0, 0, 0.8F}, 1);
  return scene;
}

/// All there is at once.
inline scene::Scene everything() {
  scene::Scene scene = masked();
  const scene::Scene other = small_room();
  const auto first = static_cast<scene::Index>(scene.materials.size());
  scene.materials.insert(scene.materials.end(), other.materials.begin(), other.materials.end());
  for (scene::Mesh mesh : other.meshes) {
    mesh.material += first;
    scene.instances.push_back({static_cast<scene::Index>(scene.meshes.size()), DMat4{1.0}});
    scene.meshes.push_back(std::move(mesh));
  }
  scene.settings.ambient = other.settings.ambient;
  scene.environment = scene::Environment{};
  scene.environment->radiance(0, 0) = {0.4F, 0.5F, 0.7F};
  return scene;
}

inline scene::Scene nothing_to_see() {
  scene::Scene scene;
  scene.name = "nothing";
  return scene;
}

}  // namespace macula::test
