#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "server/visibility/moving_triangles.h"
#include "shared/math/hash.h"
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

/// Of `count` rays straight at (x, y) of masked_square() or copies of it, the share that meets one.
double met_share(const TriangleScene& scene, float x, float y, Coherence coherence,
                 const std::function<BlendRule(int)>& rule, int count = 1 << 14) {
  RayStream rays;
  OcclusionStream hidden;
  HitStream hits;
  int met = 0;
  for (int first = 0; first < count; first += kStreamCapacity) {
    rays.clear();
    for (int i = 0; i < kStreamCapacity; ++i) {
      rays.push({x, y, 1}, {0, 0, -1}, 0.0F, 10.0F, rule(first + i));
    }
    scene.occluded(rays, hidden, coherence);
    scene.intersect(rays, hits, coherence);
    for (int i = 0; i < rays.count; ++i) {
      EXPECT_EQ(hidden.occluded[i] != 0, hits.hit(i));
      met += hidden.occluded[i];
    }
  }
  return static_cast<double>(met) / count;
}
BlendRule by_chance(int i) {
  return blend_by_chance(static_cast<std::uint32_t>(math::hash_mix(static_cast<unsigned>(i))));
}
BlendRule by_half(int) {
  return blend_from(0.5F);
}
double four_deviations(double p, int count = 1 << 14) {
  return 4.0 * std::sqrt(p * (1.0 - p) / count);
}

TEST(Alpha, BlendIsMetAsOftenAsItsCoverageBetweenTexelsSays) {
  scene::Scene source = masked_square(scene::AlphaMode::Blend);
  source.materials[0].alpha = 0.8F;
  source.materials[0].base_color_texture->wrap_u = scene::Wrap::Clamp;
  source.materials[0].base_color_texture->wrap_v = scene::Wrap::Clamp;
  source.images[0].pixels(1, 0).a = 51;
  for (const auto packets : {PacketWidth::One, PacketWidth::Eight, PacketWidth::Sixteen}) {
    const auto scene = make(source, packets);
    // Two fifths of the way from the first texel, 255, to the second, 51: 0.8 (1 - 0.4 0.8).
    const double half_way = 0.8 * (1.0 - 0.4 * 0.8);
    const float x = 0.25F + 0.4F * 0.5F;
    EXPECT_NEAR(met_share(*scene, x, 0.75F, Coherence::Coherent, by_chance), half_way,
                four_deviations(half_way));
    EXPECT_NEAR(met_share(*scene, 0.1F, 0.9F, Coherence::Coherent, by_chance), 0.8,
                four_deviations(0.8));
    EXPECT_EQ(met_share(*scene, x, 0.75F, Coherence::Coherent, by_half, 256), 1.0) << "a mask";
    EXPECT_EQ(met_share(*scene, 0.1F, 0.1F, Coherence::Coherent, by_chance, 256), 0.0);
  }
}

TEST(Alpha, BlendedSurfacesBehindOneAnotherHideIndependently) {
  scene::Scene source = masked_square(scene::AlphaMode::Blend);
  source.materials[0].base_color_texture.reset();
  source.materials[0].alpha = 0.5F;
  // Enough copies of each triangle that the mesh is shared and rays may go as a stream, all of them
  // out of the way but the first two.
  scene::Mesh& mesh = source.meshes[0];
  mesh.positions.insert(mesh.positions.end(), {{9, 9, 9}, {9, 8, 9}, {8, 9, 9}});
  while (mesh.triangles.size() < 600) mesh.triangles.push_back({4, 5, 6});
  source.instances.push_back({0, glm::translate(DMat4(1.0), DVec3(0, 0, -1))});
  Options flat, instanced{.flat_triangles = 0}, narrow{.packets = PacketWidth::Eight};
  for (const Options& options : {flat, instanced, narrow}) {
    const auto scene = TriangleScene::create(source, options);
    ASSERT_TRUE(scene);
    for (const auto coherence : {Coherence::Coherent, Coherence::Incoherent}) {
      const double met = met_share(**scene, 0.3F, 0.6F, coherence, by_chance);
      EXPECT_NEAR(met, 0.75, four_deviations(0.75));
    }
  }
}

TEST(Alpha, BlendMeetsTheSameRaysHoweverTheSceneIsKept) {
  scene::Scene source = masked_square(scene::AlphaMode::Blend);
  source.materials[0].alpha = 0.6F;
  while (source.meshes[0].triangles.size() < 600) source.meshes[0].triangles.push_back({0, 0, 0});
  source.instances.push_back({0, glm::translate(DMat4(1.0), DVec3(0, 0, -1))});
  RayStream rays;
  for (int i = 0; i < kStreamCapacity; ++i) {
    rays.push({0.2F, 0.8F, 1}, {0, 0, -1}, 0.0F, 10.0F, by_chance(i));
  }
  const auto flat = TriangleScene::create(source, Options{.packets = PacketWidth::One});
  const auto shared = TriangleScene::create(source, Options{.flat_triangles = 0});
  auto moving = MovingTriangles::create(source, {}, scene::pose_at(source, {}));
  ASSERT_TRUE(moving);
  const auto moved = (*moving)->make(scene::pose_at(source, {}));
  ASSERT_TRUE(moved);
  HitStream expected, hits;
  (*flat)->intersect(rays, expected, Coherence::Coherent);
  int behind = 0;
  for (const TriangleScene* scene :
       {shared->get(), static_cast<const TriangleScene*>(moved->get())}) {
    scene->intersect(rays, hits, Coherence::Incoherent);
    for (int i = 0; i < rays.count; ++i) EXPECT_EQ(hits.instance[i], expected.instance[i]);
  }
  for (int i = 0; i < rays.count; ++i) behind += expected.instance[i] == 1 ? 1 : 0;
  EXPECT_NEAR(behind / 256.0, 0.24, 4.0 * std::sqrt(0.24 * 0.76 / 256.0));
}

}  // namespace
}  // namespace macula::visibility
