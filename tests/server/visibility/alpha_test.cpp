#include <gtest/gtest.h>

#include "tests/server/visibility/meshes.h"

namespace macula::visibility {
namespace {

/// A unit square at z = 0 that faces +Z, uv = (x, 1 - y), with a 2x2 texture: only the top-left and
/// bottom-right texels are there.
scene::Scene masked_square(scene::AlphaMode mode) {
  scene::Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.texcoords = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene::Scene scene = test::scene_of(std::move(mesh));
  scene.images.push_back({"checks", image::Plane<image::Rgba8>(2, 2)});
  scene.images[0].pixels(1, 0).a = 0;
  scene.images[0].pixels(0, 1).a = 0;
  scene.materials[0].base_color_texture = scene::TextureRef{};
  scene.materials[0].alpha_mode = mode;
  return scene;
}

bool is_there(const TriangleScene& scene, float x, float y) {
  const Ray ray{{x, y, 1}, {0, 0, -1}};
  const bool hit = scene.intersect(ray).has_value();
  EXPECT_EQ(scene.occluded(ray), hit);
  return hit;
}

std::shared_ptr<const TriangleScene> make(const scene::Scene& scene,
                                          PacketWidth packets = PacketWidth::Device) {
  auto made = TriangleScene::create(scene, {.packets = packets, .flat_triangles = 0});
  EXPECT_TRUE(made);
  return *made;
}

TEST(Alpha, MaskAndBlendLetRaysThroughTheirEmptyTexels) {
  for (const auto mode : {scene::AlphaMode::Mask, scene::AlphaMode::Blend}) {
    const auto scene = make(masked_square(mode));
    EXPECT_TRUE(is_there(*scene, 0.25F, 0.75F));
    EXPECT_FALSE(is_there(*scene, 0.75F, 0.75F));
    EXPECT_FALSE(is_there(*scene, 0.25F, 0.25F));
    EXPECT_TRUE(is_there(*scene, 0.75F, 0.25F));
  }
}

TEST(Alpha, OpaqueMaterialsIgnoreAlpha) {
  const auto scene = make(masked_square(scene::AlphaMode::Opaque));
  EXPECT_TRUE(is_there(*scene, 0.75F, 0.75F));
  EXPECT_TRUE(is_there(*scene, 0.25F, 0.25F));
}

TEST(Alpha, CutoffAndFactorDecideTogether) {
  scene::Scene source = masked_square(scene::AlphaMode::Mask);
  source.images[0].pixels(1, 0).a = 128;  // 0.502
  source.materials[0].alpha_cutoff = 0.5F;
  EXPECT_TRUE(is_there(*make(source), 0.75F, 0.75F));
  source.materials[0].alpha = 0.9F;  // 0.452 < 0.5
  EXPECT_FALSE(is_there(*make(source), 0.75F, 0.75F));
  EXPECT_TRUE(is_there(*make(source), 0.25F, 0.75F));
  source.materials[0].alpha = 0.4F;  // nothing reaches the cutoff
  EXPECT_FALSE(is_there(*make(source), 0.25F, 0.75F));
}

TEST(Alpha, TextureTransformsAndWrapModesMoveTheHoles) {
  scene::Scene source = masked_square(scene::AlphaMode::Mask);
  auto& texture = *source.materials[0].base_color_texture;
  texture.uv_offset = {0.5F, 0.0F};  // half the square: texels swap sides
  EXPECT_FALSE(is_there(*make(source), 0.25F, 0.75F));
  EXPECT_TRUE(is_there(*make(source), 0.75F, 0.75F));  // u in [1, 1.5) repeats
  texture.wrap_u = scene::Wrap::Clamp;                 // ... or stays at the last column
  EXPECT_FALSE(is_there(*make(source), 0.75F, 0.75F));
  texture.wrap_u = scene::Wrap::Mirror;
  EXPECT_FALSE(is_there(*make(source), 0.75F, 0.75F));
  texture.uv_offset = {1.0F, 0.0F};  // wholly in the mirrored copy
  EXPECT_FALSE(is_there(*make(source), 0.25F, 0.75F));
  EXPECT_TRUE(is_there(*make(source), 0.75F, 0.75F));
  texture = scene::TextureRef{};
  texture.uv_scale = {2.0F, 1.0F};  // twice as many columns
  EXPECT_TRUE(is_there(*make(source), 0.125F, 0.75F));
  EXPECT_FALSE(is_there(*make(source), 0.375F, 0.75F));
  EXPECT_TRUE(is_there(*make(source), 0.625F, 0.75F));
}

TEST(Alpha, WorksInsideInstancesAndPacketsOfEveryWidth) {
  scene::Scene source = masked_square(scene::AlphaMode::Mask);
  // Enough copies of the same two triangles that the mesh is shared between its two instances.
  auto& triangles = source.meshes[0].triangles;
  while (triangles.size() < 512) triangles.insert(triangles.end(), {{0, 1, 2}, {0, 2, 3}});
  source.instances.push_back({0, glm::translate(DMat4(1.0), DVec3(0, 0, -1))});
  for (const auto packets : {PacketWidth::One, PacketWidth::Eight, PacketWidth::Sixteen}) {
    const auto scene = make(source, packets);
    RayStream rays;
    HitStream hits;
    for (int i = 0; i < 40; ++i) {
      const float x = (static_cast<float>(i % 10) + 0.5F) / 10.0F;
      const float y = (static_cast<float>(i / 10) + 0.5F) / 4.0F;
      rays.push({x, y, 1}, {0, 0, -1}, 0.0F, 10.0F);
    }
    scene->intersect(rays, hits, Coherence::Coherent);
    for (int i = 0; i < rays.count; ++i) {
      EXPECT_EQ(hits.hit(i), (rays.ox[i] < 0.5F) == (rays.oy[i] > 0.5F));
    }
  }
}

}  // namespace
}  // namespace macula::visibility
