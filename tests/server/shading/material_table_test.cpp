#include "server/shading/material_table.h"

#include <gtest/gtest.h>

#include "server/shading/surface.h"

namespace macula::shading {
namespace {

scene::Scene one_material(const scene::Material& material) {
  scene::Scene scene;
  scene.materials = {material};
  return scene;
}

TEST(MaterialTable, WithoutSpecularReflectionAMaterialIsExactlyLambert) {
  scene::Material material;
  material.base_color = {0.7F, 0.5F, 0.3F};
  material.specular = 0.0F;
  const MaterialTable table(one_material(material));
  const Bsdf bsdf = table.bsdf(0, Vec2{0.0F}, 0.0F, MaterialModel::AsInScene);
  EXPECT_FALSE(bsdf.glossy());
  EXPECT_EQ(bsdf.albedo, material.base_color);
}

TEST(MaterialTable, AMetalHasNoDiffusePartAndItsColourInTheLobe) {
  scene::Material material;
  material.base_color = {0.9F, 0.6F, 0.2F};
  material.metallic = 1.0F;
  material.roughness = 0.5F;
  const MaterialTable table(one_material(material));
  const Bsdf bsdf = table.bsdf(0, Vec2{0.0F}, 0.0F, MaterialModel::AsInScene);
  EXPECT_EQ(bsdf.albedo, Rgb{0.0F});
  EXPECT_EQ(bsdf.f0, material.base_color);
  EXPECT_FLOAT_EQ(bsdf.alpha, 0.25F);
}

TEST(MaterialTable, LambertModelKeepsTheBaseColourOfAMetal) {
  scene::Material material;
  material.base_color = {0.9F, 0.6F, 0.2F};
  material.metallic = 1.0F;
  const MaterialTable table(one_material(material));
  const Bsdf bsdf = table.bsdf(0, Vec2{0.0F}, 0.0F, MaterialModel::Lambert);
  EXPECT_FALSE(bsdf.glossy());
  EXPECT_EQ(bsdf.albedo, material.base_color);
}

TEST(MaterialTable, MeanEmissionIsThatOfTheTexture) {
  scene::Scene scene;
  scene.images.resize(1);
  scene.images[0].pixels = image::Plane<image::Rgba8>(2, 1);
  scene.images[0].pixels(0, 0) = {255, 255, 255, 255};
  scene::Material material;
  material.emission = Rgb{8.0F};
  material.emission_texture = scene::TextureRef{};
  scene.materials = {material};
  const MaterialTable table(scene);
  EXPECT_TRUE(table.emits(0));
  EXPECT_FLOAT_EQ(table.mean_emission(0).x, 4.0F);
  EXPECT_FLOAT_EQ(table.emission(0, {0.25F, 0.5F}, 0.0F).x, 8.0F);
}

scene::Scene one_triangle(const DMat4& world_from_object) {
  scene::Scene scene;
  scene.materials.resize(1);
  scene::Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.texcoords = {{0, 0}, {3, 0}, {0, 3}};
  mesh.triangles = {{0, 1, 2}};
  scene.meshes = {mesh};
  scene.instances = {{0, world_from_object}};
  return scene;
}

TEST(SurfaceTable, PlacesPointsByInstanceAndBarycentrics) {
  DMat4 move{2.0};
  move[3] = {10.0, 20.0, 30.0, 1.0};
  const scene::Scene scene = one_triangle(move);
  const Surface surface = SurfaceTable(scene).at(0, 0, {0.25F, 0.5F});
  EXPECT_NEAR(glm::length(surface.position - DVec3(10.5, 21.0, 30.0)), 0.0, 1e-12);
  EXPECT_EQ(surface.geometric_normal, Vec3(0.0F, 0.0F, 1.0F));
  EXPECT_FLOAT_EQ(surface.uv.x, 0.75F);
  EXPECT_FLOAT_EQ(SurfaceTable(scene).uv_per_meter(0, 0), 1.5F);
}

TEST(SurfaceTable, MirroringKeepsTheFrontInFront) {
  DMat4 mirror{1.0};
  mirror[2][2] = -1.0;
  const scene::Scene flipped = one_triangle(mirror);
  EXPECT_EQ(SurfaceTable(flipped).at(0, 0, Vec2{0.2F}).geometric_normal, Vec3(0.0F, 0.0F, -1.0F));
  mirror[2][2] = 1.0, mirror[0][0] = -1.0;
  const scene::Scene sideways = one_triangle(mirror);
  EXPECT_EQ(SurfaceTable(sideways).at(0, 0, Vec2{0.2F}).geometric_normal, Vec3(0.0F, 0.0F, 1.0F));
}

TEST(MaterialTable, APatternPutsItsSecondColourWhereItSays) {
  scene::Scene scene;
  scene.materials.resize(1);
  scene.materials[0].base_color = Rgb{0.8F};
  scene.materials[0].specular = 0.0F;
  scene.materials[0].pattern = scene::Pattern{scene::PatternKind::Checker, Rgb{0.1F}, 1.0F};
  const MaterialTable table(scene);
  const Vec3 up{0.0F, 1.0F, 0.0F};
  EXPECT_EQ(table.base_color(0, PatternPoint{{0.5F, 0.0F, 0.5F}, up, Vec3{0.0F}}), Rgb{0.8F});
  EXPECT_EQ(table.base_color(0, PatternPoint{{1.5F, 0.0F, 0.5F}, up, Vec3{0.0F}}), Rgb{0.1F});
  const Bsdf bsdf = table.bsdf(0, Rgb{0.1F}, MaterialModel::AsInScene);
  EXPECT_EQ(bsdf.albedo, Rgb{0.1F});
  EXPECT_FALSE(bsdf.glossy());
}

}  // namespace
}  // namespace macula::shading
