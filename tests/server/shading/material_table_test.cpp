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

TEST(MaterialTable, SpecularTexturesScaleTheLobeOfADielectric) {
  scene::Material material;
  material.specular = 0.5F;
  material.specular_color = Rgb{2.0F};
  scene::Scene scene;
  scene.images.push_back({"strength", image::Plane<image::Rgba8>(1, 1, {9, 9, 9, 51})});
  scene.images.push_back({"colour", image::Plane<image::Rgba8>(1, 1, {255, 188, 0, 7})});
  material.specular_texture = scene::TextureRef{.image = 0, .space = scene::ColorSpace::Linear};
  material.specular_color_texture = scene::TextureRef{.image = 1};
  scene.materials = {material};
  const MaterialTable table(scene);
  EXPECT_TRUE(table.textured(0));
  const Bsdf bsdf = table.bsdf(0, Vec2{0.3F}, 0.0F, MaterialModel::AsInScene);
  // Half of a fifth of 0.04 x 2 x (1, 0.503, 0): sRGB 188 is linear 0.503.
  EXPECT_NEAR(bsdf.f90, 0.1F, 1e-6F);
  EXPECT_NEAR(bsdf.f0.x, 0.008F, 1e-6F);
  EXPECT_NEAR(bsdf.f0.y, 0.008F * 0.503F, 1e-5F);
  EXPECT_EQ(bsdf.f0.z, 0.0F);
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
