#include <gtest/gtest.h>

#include "tests/server/visibility/meshes.h"

namespace macula::visibility {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Moeller and Trumbore (1997) in double, both faces; t, or infinity.
double reference_t(const scene::Mesh& mesh, const UVec3& corners, const DVec3& origin,
                   const DVec3& direction) {
  const DVec3 p0(mesh.positions[corners.x]);
  const DVec3 e1 = DVec3(mesh.positions[corners.y]) - p0,
              e2 = DVec3(mesh.positions[corners.z]) - p0;
  const DVec3 p = glm::cross(direction, e2);
  const double determinant = glm::dot(e1, p);
  if (determinant == 0.0) return kInfinity;
  const DVec3 s = origin - p0, q = glm::cross(s, e1);
  const double u = glm::dot(s, p) / determinant, v = glm::dot(direction, q) / determinant;
  const double t = glm::dot(e2, q) / determinant;
  return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 ? t : static_cast<double>(kInfinity);
}

struct Reference {
  double t = static_cast<double>(kInfinity);
  std::uint32_t triangle = kNothing;
};
Reference closest(const scene::Mesh& mesh, const RayStream& rays, int i) {
  Reference best;
  for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k) {
    const double t =
        reference_t(mesh, mesh.triangles[k], DVec3(rays.origin(i)), DVec3(rays.direction(i)));
    if (t < best.t) best = {t, k};
  }
  return best;
}

std::shared_ptr<const TriangleScene> make(const scene::Scene& scene, const Options& options = {}) {
  auto made = TriangleScene::create(scene, options);
  EXPECT_TRUE(made) << made.error().message();
  return *made;
}

TEST(Queries, AgreeWithBruteForceInDouble) {
  const scene::Mesh mesh = test::make_triangle_soup(200);
  const auto scene = make(test::scene_of(mesh));
  int differ = 0, hit_count = 0;
  RayStream rays;
  HitStream hits;
  for (std::uint64_t stream = 0; stream < 40; ++stream) {
    test::fill_random_rays(rays, stream, 1.5F);
    scene->intersect(rays, hits, Coherence::Incoherent);
    for (int i = 0; i < rays.count; ++i) {
      const Reference expected = closest(mesh, rays, i);
      if ((expected.triangle != kNothing) != hits.hit(i)) {
        ++differ;  // through an edge, within rounding of it
        continue;
      }
      if (!hits.hit(i)) continue;
      ++hit_count;
      // A grazing hit stretches float error along the ray by 1 / cos.
      const double cosine = std::abs(glm::dot(DVec3(hits.normal(i)), DVec3(rays.direction(i))));
      EXPECT_NEAR(hits.t[i], expected.t, 3e-6 / cosine);
      differ += hits.triangle[i] == expected.triangle ? 0 : 1;
    }
  }
  EXPECT_GT(hit_count, 2000);
  EXPECT_LE(differ, 2);
}

TEST(Queries, BarycentricsAndNormalBelongToTheTriangle) {
  const scene::Mesh mesh = test::make_bumpy_sphere(3, 0.1F);
  const auto scene = make(test::scene_of(mesh));
  RayStream rays;
  HitStream hits;
  test::fill_random_rays(rays, 1, 0.3F);
  scene->intersect(rays, hits, Coherence::Incoherent);
  for (int i = 0; i < rays.count; ++i) {
    ASSERT_TRUE(hits.hit(i));
    const UVec3 t = mesh.triangles[hits.triangle[i]];
    const Vec3 &p0 = mesh.positions[t.x], &p1 = mesh.positions[t.y], &p2 = mesh.positions[t.z];
    const Vec3 by_corners = (1.0F - hits.u[i] - hits.v[i]) * p0 + hits.u[i] * p1 + hits.v[i] * p2;
    EXPECT_LT(glm::distance(by_corners, rays.origin(i) + hits.t[i] * rays.direction(i)), 2e-6F);
    const Vec3 outwards = glm::normalize(glm::cross(p1 - p0, p2 - p0));
    EXPECT_LT(glm::distance(hits.normal(i), outwards), 1e-5F);
  }
}

TEST(Queries, OcclusionAgreesWithTheClosestHitUpToAnyDistance) {
  const auto scene = make(test::scene_of(test::make_triangle_soup(200)));
  RayStream rays;
  HitStream hits;
  OcclusionStream blocked;
  int free_count = 0;
  for (std::uint64_t stream = 0; stream < 20; ++stream) {
    test::fill_random_rays(rays, stream, 1.5F);
    scene->intersect(rays, hits, Coherence::Incoherent);
    for (int i = 0; i < rays.count; ++i) {  // end half of the rays just before what they met
      if (hits.hit(i) && i % 2 == 0) rays.tfar[i] = hits.t[i] * 0.999F;
    }
    scene->occluded(rays, blocked, Coherence::Incoherent);
    for (int i = 0; i < rays.count; ++i) {
      const bool expected = hits.hit(i) && i % 2 != 0;
      EXPECT_EQ(blocked.occluded[i] != 0, expected) << "stream " << stream << ", ray " << i;
      free_count += expected ? 0 : 1;
    }
  }
  EXPECT_GT(free_count, 1000);
}

TEST(Queries, PacketsOfOneEightAndSixteenGiveTheSameAnswers) {
  const scene::Scene source = test::scene_of(test::make_triangle_soup(300));
  const auto one = make(source, {.packets = PacketWidth::One});
  const auto eight = make(source, {.packets = PacketWidth::Eight});
  const auto sixteen = make(source, {.packets = PacketWidth::Sixteen});
  EXPECT_EQ(one->packet_width(), 1);
  EXPECT_EQ(eight->packet_width(), 8);
  EXPECT_EQ(sixteen->packet_width(), 16);
  EXPECT_TRUE(make(source)->packet_width() == 8 || make(source)->packet_width() == 16);
  RayStream rays;
  HitStream a, b;
  OcclusionStream c, d;
  for (std::uint64_t stream = 0; stream < 20; ++stream) {
    test::fill_random_rays(rays, stream, 1.5F);
    rays.count = 256 - static_cast<int>(stream);  // tails of every length
    one->intersect(rays, a, Coherence::Coherent);
    one->occluded(rays, c, Coherence::Coherent);
    for (const auto& wide : {eight, sixteen}) {
      wide->intersect(rays, b, Coherence::Incoherent);
      wide->occluded(rays, d, Coherence::Incoherent);
      for (int i = 0; i < rays.count; ++i) {
        ASSERT_EQ(a.instance[i], b.instance[i]);
        ASSERT_EQ(c.occluded[i], d.occluded[i]);
        if (!a.hit(i)) continue;
        ASSERT_EQ(a.triangle[i], b.triangle[i]);
        ASSERT_NEAR(a.t[i], b.t[i], 1e-5F * a.t[i]);
      }
    }
  }
}

TEST(Queries, ScatteredRaysAreBlockedAsSingleOnesAre) {
  const scene::Scene source = test::scene_of(test::make_triangle_soup(1200));  // enough for streams
  const auto device = make(source), one = make(source, {.packets = PacketWidth::One});
  RayStream rays;
  OcclusionStream a, b;
  int blocked = 0;
  for (std::uint64_t stream = 0; stream < 20; ++stream) {
    test::fill_random_rays(rays, stream, 1.5F);
    for (int i = 0; i < rays.count; ++i) rays.tfar[i] = i % 3 == 0 ? -1.0F : 0.3F;  // some idle
    device->occluded(rays, a, Coherence::Incoherent);
    one->occluded(rays, b, Coherence::Coherent);
    for (int i = 0; i < rays.count; ++i) {
      ASSERT_EQ(a.occluded[i], b.occluded[i]) << "stream " << stream << ", ray " << i;
      blocked += a.occluded[i];
    }
  }
  EXPECT_GT(blocked, 500);
  EXPECT_LT(blocked, 3000);
}

TEST(Queries, ATailLeavesTheRestOfTheStreamAlone) {
  const auto scene = make(test::scene_of(test::make_bumpy_sphere(2, 0.0F)));
  RayStream rays;
  HitStream hits;
  OcclusionStream blocked;
  test::fill_random_rays(rays, 1, 0.3F);
  for (const int count : {0, 1, 7, 8, 9, 15, 16, 17, 255, 256}) {
    rays.count = count;
    std::fill_n(hits.instance, kStreamCapacity, 77U);
    std::fill_n(blocked.occluded, kStreamCapacity, std::uint8_t{77});
    scene->intersect(rays, hits, Coherence::Coherent);
    scene->occluded(rays, blocked, Coherence::Coherent);
    for (int i = 0; i < kStreamCapacity; ++i) {
      EXPECT_EQ(hits.instance[i], i < count ? 0U : 77U);
      EXPECT_EQ(blocked.occluded[i], i < count ? 1 : 77);
    }
  }
}

TEST(Queries, InstancesEqualFlattenedCopies) {
  const scene::Mesh mesh = test::make_bumpy_sphere(3, 0.2F);  // enough triangles to be shared
  std::vector<DMat4> placed;
  for (int i = 0; i < 4; ++i) {
    DMat4 at = glm::translate(DMat4(1.0), DVec3(1.5 * i - 2.0, 0.3 * i, 0.1));
    at = glm::rotate(at, 0.7 * i, glm::normalize(DVec3(1, 2, 3)));
    placed.push_back(glm::scale(at, DVec3(0.5, i == 2 ? -0.6 : 0.6, 0.7)));  // one mirrors
  }
  scene::Scene flat = test::scene_of(mesh, placed);
  for (scene::Index i = 0; i < 4; ++i) {
    flat.meshes.push_back(mesh);
    flat.instances[i].mesh = i + 1;  // a mesh of its own each: flattened
  }
  const auto shared = make(test::scene_of(mesh, placed), {.flat_triangles = 0});
  const auto copied = make(flat, {.flat_triangles = 0});
  const auto at_once = make(test::scene_of(mesh, placed));
  RayStream rays;
  HitStream a, b, c;
  int hit_count = 0, differ = 0;
  for (std::uint64_t stream = 0; stream < 40; ++stream) {
    test::fill_random_rays(rays, stream, 3.0F);
    shared->intersect(rays, a, Coherence::Incoherent);
    copied->intersect(rays, b, Coherence::Incoherent);
    at_once->intersect(rays, c, Coherence::Incoherent);
    EXPECT_TRUE(std::equal(b.instance, b.instance + rays.count, c.instance));
    for (int i = 0; i < rays.count; ++i) {
      if (a.instance[i] != b.instance[i] || (a.hit(i) && a.triangle[i] != b.triangle[i])) {
        ++differ;  // silhouettes and edges, within rounding of the transforms
        continue;
      }
      if (!a.hit(i)) continue;
      ++hit_count;
      const double cosine = std::abs(glm::dot(a.normal(i), rays.direction(i)));
      EXPECT_NEAR(a.t[i], b.t[i], 1e-5 / cosine);
      EXPECT_LT(glm::distance(a.normal(i), b.normal(i)), 1e-4F);
    }
  }
  EXPECT_GT(hit_count, 500);
  EXPECT_LE(differ, hit_count / 500);
}

TEST(Queries, NormalsPointToTheFrontAlsoUnderMirroring) {
  // Seen from outside, the front of the sphere faces the ray, whatever the instance's transform.
  const scene::Mesh mesh = test::make_bumpy_sphere(3, 0.0F);
  for (const std::size_t copies : {1U, 2U}) {  // flattened; instanced
    const DMat4 mirrored = glm::scale(DMat4(1.0), DVec3(-1, 1, 1));
    const auto scene =
        make(test::scene_of(mesh, std::vector<DMat4>(copies, mirrored)), {.flat_triangles = 0});
    const auto hit = scene->intersect(Ray{{0, 0, 5}, {0.01F, 0.02F, -1}});
    ASSERT_TRUE(hit);
    EXPECT_GT(hit->normal.z, 0.9F);
  }
}

TEST(Queries, ASceneWithoutTrianglesIsLegalAndEmpty) {
  const auto scene = make(scene::Scene{});
  EXPECT_FALSE(scene->intersect(Ray{{0, 0, 0}, {0, 0, -1}}));
  EXPECT_FALSE(scene->occluded(Ray{{0, 0, 0}, {0, 0, -1}}));
  RayStream rays;
  HitStream hits;
  test::fill_random_rays(rays, 0, 1.0F);
  scene->intersect(rays, hits, Coherence::Coherent);
  for (int i = 0; i < rays.count; ++i) EXPECT_FALSE(hits.hit(i));
}

TEST(Queries, IdleAndNonFiniteRaysMeetNothing) {
  const auto scene = make(test::scene_of(test::make_bumpy_sphere(2, 0.0F)));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  RayStream rays;
  rays.push({0, 0, 0}, {0, 0, -1}, 0.0F, kInfinity);  // the only sound one
  rays.push({nan, 0, 0}, {0, 0, -1}, 0.0F, kInfinity);
  rays.push({0, 0, 0}, {0, nan, -1}, 0.0F, kInfinity);
  rays.push({0, kInfinity, 0}, {0, 0, -1}, 0.0F, kInfinity);
  rays.push({0, 0, 0}, {0, 0, -1}, nan, kInfinity);
  rays.push({0, 0, 0}, {0, 0, -1}, 0.0F, nan);
  rays.push({0, 0, 0}, {0, 0, -1}, 1.0F, -1.0F);
  rays.push({0, 0, 0}, {0, 0, -1}, 0.0F, -kInfinity);
  HitStream hits;
  OcclusionStream blocked;
  scene->intersect(rays, hits, Coherence::Coherent);
  scene->occluded(rays, blocked, Coherence::Coherent);
  for (int i = 0; i < rays.count; ++i) {
    EXPECT_EQ(hits.hit(i), i == 0) << i;
    EXPECT_EQ(blocked.occluded[i] != 0, i == 0) << i;
  }
}

TEST(Queries, ACollapsedInstanceIsKeptAsFlatAndANonFiniteOneIsRefused) {
  const scene::Mesh mesh = test::make_bumpy_sphere(3, 0.0F);
  const DMat4 pressed = glm::scale(DMat4(1.0), DVec3(1, 1, 0));
  const auto flat = make(test::scene_of(mesh, {pressed, pressed}));
  EXPECT_TRUE(flat->intersect(Ray{{0.1F, 0.2F, 5}, {0, 0, -1}}));

  DMat4 broken(1.0);
  broken[3].y = std::numeric_limits<double>::quiet_NaN();
  const auto refused = TriangleScene::create(test::scene_of(mesh, {DMat4(1.0), broken}));
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("instance 1"), std::string::npos);
  EXPECT_EQ(refused.error().exit_status(), 2);
}

TEST(Queries, CopiesOfSmallMeshesStayWithinTheirBudget) {
  // 20,000 instances of a mesh of 20 triangles and 3 of one of 80: together above any budget of
  // less than 400,240.
  scene::Scene source = test::scene_of(test::make_bumpy_sphere(0, 0.0F));
  source.instances.clear();
  source.meshes.push_back(test::make_bumpy_sphere(1, 0.0F));
  for (int i = 0; i < 20'000; ++i) {
    const DVec3 place(3.0 * (i % 100), 0.0, 3.0 * (i / 100));
    source.instances.push_back({0, glm::translate(DMat4(1.0), place)});
  }
  for (int i = 0; i < 3; ++i) {
    source.instances.push_back({1, glm::translate(DMat4(1.0), DVec3(3.0 * i, 9.0, 0.0))});
  }
  const auto kept = [&](std::size_t flat_triangles) {
    return make(source, {.flat_triangles = flat_triangles})->triangles_kept();
  };
  EXPECT_EQ(kept(400'240), 400'240U) << "all flat";
  EXPECT_EQ(kept(400'239), 400'080U) << "the smaller mesh fits, the other is shared";
  EXPECT_EQ(kept(100'000), 260U) << "the many are shared, the few copied";
  EXPECT_EQ(kept(0), 100U) << "both are shared";
  const auto shared = make(source, {.flat_triangles = 0});
  const auto hit = shared->intersect(Ray{{150.0F, 5.0F, 300.0F}, {0.0F, -1.0F, 0.0F}});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->instance, 10'050U);
}

}  // namespace
}  // namespace macula::visibility
