// Surfaces, textures, materials and reflectors in vectors, each against its function of one point.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "server/sampling/sample.h"
#include "server/shading/material_table.h"
#include "server/shading/reflector_batch.h"
#include "server/shading/surface.h"

namespace macula::shading {
namespace {

using sampling::kBatch;
constexpr float kAgrees = 1e-5F;

struct Random {
  sampling::SampleKey key;
  float operator()(std::uint32_t dimension) const { return sampling::sample(key, dimension); }
  Vec3 vec3(std::uint32_t dimension) const {
    return Vec3{(*this)(dimension), (*this)(dimension + 1), (*this)(dimension + 2)} - 0.5F;
  }
};

image::Plane<image::Rgba8> noise(int width, int height, std::uint64_t seed) {
  image::Plane<image::Rgba8> pixels(width, height);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto byte = [&](std::uint32_t d) {
      return static_cast<std::uint8_t>(255.0F * sampling::sample({3, seed, i}, d));
    };
    pixels.pixels()[i] = {byte(0), byte(1), byte(2), byte(3)};
  }
  return pixels;
}

scene::TextureRef reference(scene::Index image, scene::ColorSpace space) {
  scene::TextureRef ref;
  ref.image = image, ref.space = space;
  ref.uv_scale = {1.7F, 0.6F}, ref.uv_offset = {0.3F, -0.4F}, ref.uv_rotation_rad = 0.7F;
  ref.wrap_v = scene::Wrap::Mirror;
  return ref;
}

/// Two instances of crumpled meshes: one with normals and texture coordinates, one with neither.
scene::Scene crumpled() {
  scene::Scene scene;
  scene.images.resize(2);
  scene.images[0].pixels = noise(37, 64, 1);
  scene.images[1].pixels = noise(16, 16, 2);
  scene::Material material;
  material.base_color = {0.9F, 0.8F, 0.7F};
  material.metallic = 0.8F, material.roughness = 0.9F;
  material.base_color_texture = reference(0, scene::ColorSpace::Srgb);
  material.metallic_roughness_texture = reference(1, scene::ColorSpace::Linear);
  material.specular_color_texture = reference(0, scene::ColorSpace::Srgb);
  scene.materials = {material, scene::Material{}};
  scene.materials[1].pattern = scene::Pattern{scene::PatternKind::Bricks, Rgb{0.1F}, 0.3F};
  for (scene::Index m = 0; m < 2; ++m) {
    scene::Mesh mesh;
    for (std::uint64_t v = 0; v < 40; ++v) {
      const Random random{{11, m, v}};
      mesh.positions.push_back(4.0F * random.vec3(0));
      if (m == 1) continue;
      mesh.normals.push_back(glm::normalize(random.vec3(3)));
      mesh.texcoords.emplace_back(3.0F * random(6) - 1.0F, 3.0F * random(7) - 1.0F);
    }
    for (std::uint32_t t = 0; t < 38; ++t) mesh.triangles.emplace_back(t, t + 1, t + 2);
    mesh.material = m;
    scene.meshes.push_back(mesh);
    scene::Instance instance{m};
    instance.parent_from_object =
        DMat4{1.5, 0.2, 0, 0, -0.3, 0.9, 0.1, 0, 0, 0.4, 2.0, 0, 5, -7, 3, 1};
    scene.instances.push_back(instance);
  }
  return scene;
}

/// What the stage makes of random points of one instance.
struct Stage {
  Stage(const scene::Scene& scene, scene::Index instance, std::size_t count,
        MaterialModel model = MaterialModel::AsInScene)
      : surfaces_of(scene), materials(scene), which(instance), n(count) {
    points.count = n;
    for (std::size_t i = 0; i < kBatch; ++i) {
      const Random random{{5, instance, i}};
      points.triangle.at[i] = static_cast<std::uint32_t>(38.0F * random(0));
      points.barycentric.x[i] = 0.5F * random(1), points.barycentric.y[i] = 0.5F * random(2);
      footprints.to_eye.set(i, glm::normalize(random.vec3(3)));
      footprints.uv.at[i] = i % 4 == 0 ? 0.0F : 0.3F * random(6) * random(6);
      footprints.width_m.at[i] = 0.02F * random(7);
    }
    surfaces_of.at(which, points, surfaces);
    materials.bsdf(which, surfaces, footprints, n, model, bsdfs);
    make_reflectors(bsdfs, surfaces, footprints.to_eye, n, reflectors);
  }
  Surface one_by_one(std::size_t i) const {
    return surfaces_of.at(which, points.triangle.at[i],
                          {points.barycentric.x[i], points.barycentric.y[i]});
  }
  SampleFootprint footprint(std::size_t i) const {
    return {footprints.uv.at[i], footprints.width_m.at[i], footprints.to_eye[i]};
  }

  SurfaceTable surfaces_of;
  MaterialTable materials;
  scene::Index which;
  std::size_t n;
  PointsOnTriangles points{};
  FootprintBatch footprints{};
  SurfaceBatch surfaces{};
  BsdfBatch bsdfs{};
  ReflectorBatch reflectors{};
};

void expect_near(const Vec3& a, const Vec3& b, float tolerance) {
  for (int c = 0; c < 3; ++c) ASSERT_NEAR(a[c], b[c], tolerance);
}

TEST(SurfaceStage, PointsOfAnInstanceLieWhereTheyLieOneByOne) {
  const scene::Scene scene = crumpled();
  for (scene::Index instance = 0; instance < 2; ++instance) {
    const Stage stage(scene, instance, 201);
    for (std::size_t i = 0; i < stage.n; ++i) {
      const Surface alone = stage.one_by_one(i);
      expect_near(stage.surfaces.position[i], Vec3(alone.position),
                  1e-6F);  // a unit in the last place
      expect_near(stage.surfaces.geometric[i], alone.geometric_normal, kAgrees);
      expect_near(stage.surfaces.shading[i], alone.shading_normal, kAgrees);
      ASSERT_NEAR(stage.surfaces.uv[i].x, alone.uv.x, kAgrees);
      ASSERT_NEAR(stage.surfaces.uv[i].y, alone.uv.y, kAgrees);
      ASSERT_FLOAT_EQ(stage.surfaces.span_m.at[i], alone.span_m);
      ASSERT_FLOAT_EQ(stage.surfaces.uv_per_meter.at[i],
                      stage.surfaces_of.uv_per_meter(instance, stage.points.triangle.at[i]));
    }
  }
}

class SurfaceStageWith : public testing::TestWithParam<MaterialModel> {};

TEST_P(SurfaceStageWith, ItsMaterialsReflectorsAreThoseOfEveryPointAlone) {
  const scene::Scene scene = crumpled();
  for (scene::Index instance = 0; instance < 2; ++instance) {
    const Stage stage(scene, instance, kBatch, GetParam());
    for (std::size_t i = 0; i < stage.n; ++i) {
      const Surface alone = stage.one_by_one(i);
      const Bsdf bsdf = stage.materials.bsdf(alone, stage.footprint(i), GetParam());
      const Reflector reflector(bsdf,
                                make_shading_frame(alone.geometric_normal, alone.shading_normal,
                                                   stage.footprints.to_eye[i]));
      ReflectorBatch wanted{};
      wanted.set(0, reflector);
      expect_near(stage.bsdfs.base[i], stage.materials.base_color(alone, stage.footprint(i)),
                  kAgrees);
      expect_near(stage.reflectors.geometric[i], wanted.geometric[0], kAgrees);
      expect_near(stage.reflectors.shading[i], wanted.shading[0], kAgrees);
      expect_near(stage.reflectors.diffuse[i], wanted.diffuse[0], kAgrees);
      expect_near(stage.reflectors.f0[i], wanted.f0[0], kAgrees);
      expect_near(stage.reflectors.reflectance[i], wanted.reflectance[0], kAgrees);
      ASSERT_NEAR(stage.reflectors.alpha.at[i], wanted.alpha.at[0], kAgrees);
      ASSERT_NEAR(stage.reflectors.f90.at[i], wanted.f90.at[0], kAgrees);
      ASSERT_NEAR(stage.reflectors.cos_v.at[i], wanted.cos_v.at[0], kAgrees);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, SurfaceStageWith,
                         testing::Values(MaterialModel::AsInScene, MaterialModel::Phong),
                         [](const auto& tested) {
                           return tested.param == MaterialModel::Phong ? "Phong" : "AsInScene";
                         });

// The twin of the test above: half a texel beside, nothing agrees.
TEST(SurfaceStage, HalfATexelBesideIsSeen) {
  scene::Scene scene = crumpled();
  const Stage stage(scene, 0, kBatch);
  scene.materials[0].base_color_texture->uv_offset.x += 0.5F / 37.0F;
  const Stage beside(scene, 0, kBatch);
  float most = 0.0F;
  for (std::size_t i = 0; i < kBatch; ++i)
    most = std::max(most, std::abs(stage.bsdfs.base[i].x - beside.bsdfs.base[i].x));
  EXPECT_GT(most, 0.01F);
}

TEST(SurfaceStage, TexturesReadAlikeInEveryWrapAtEveryWidth) {
  const Texture texture(noise(37, 20, 9), scene::ColorSpace::Srgb);
  using scene::Wrap;
  for (const Wrap u : {Wrap::Repeat, Wrap::Clamp, Wrap::Mirror}) {
    for (const Wrap v : {Wrap::Repeat, Wrap::Clamp, Wrap::Mirror}) {
      sampling::Vec2Batch uv{};
      sampling::FloatBatch footprint{};
      for (std::size_t i = 0; i < kBatch; ++i) {
        const Random random{{21, 0, i}};
        uv.x[i] = 6.0F * random(0) - 3.0F, uv.y[i] = 6.0F * random(1) - 3.0F;
        footprint.at[i] = i % 3 == 0 ? 0.0F : std::exp2(4.0F - 12.0F * random(2));
      }
      uv.x[7] = INFINITY, uv.y[8] = NAN, footprint.at[9] = NAN, footprint.at[10] = INFINITY;
      uv.x[11] = -1e-9F, uv.y[12] = 1e8F;
      TexelBatch out;
      texture.sample(uv, footprint, u, v, kBatch, kColorChannels | kAlphaChannel, out);
      for (std::size_t i = 0; i < kBatch; ++i) {
        const Vec4 alone = texture.sample(uv[i], footprint.at[i], u, v);
        for (int c = 0; c < 4; ++c) ASSERT_NEAR(out.channel[c].at[i], alone[c], kAgrees) << i;
      }
    }
  }
}

TEST(SurfaceStage, WhatAPointBecomesDoesNotDependOnItsPlace) {
  const scene::Scene scene = crumpled();
  const Stage all(scene, 0, kBatch);
  Stage one(scene, 0, 1);
  for (const std::size_t i : {3U, 17U, 200U}) {
    PointsOnTriangles& points = one.points;
    points.triangle.at[0] = all.points.triangle.at[i];
    points.barycentric.x[0] = all.points.barycentric.x[i];
    points.barycentric.y[0] = all.points.barycentric.y[i];
    FootprintBatch footprints = one.footprints;
    footprints.to_eye.set(0, all.footprints.to_eye[i]);
    footprints.uv.at[0] = all.footprints.uv.at[i];
    one.surfaces_of.at(0, points, one.surfaces);
    one.materials.bsdf(0, one.surfaces, footprints, 1, MaterialModel::AsInScene, one.bsdfs);
    make_reflectors(one.bsdfs, one.surfaces, footprints.to_eye, 1, one.reflectors);
    EXPECT_EQ(one.surfaces.position[0], all.surfaces.position[i]);
    EXPECT_EQ(one.bsdfs.albedo[0], all.bsdfs.albedo[i]);
    EXPECT_EQ(one.reflectors.diffuse[0], all.reflectors.diffuse[i]);
  }
}

}  // namespace
}  // namespace macula::shading
