// Rays inside a closed mesh have nowhere to go: each must hit. Without the robust edge test a few
// in ten thousand slip between triangles that share an edge, which shows as pinholes of light.
#include <gtest/gtest.h>

#include <atomic>

#include "server/scheduling/tile_scheduler.h"
#include "tests/server/visibility/meshes.h"

namespace macula::visibility {
namespace {

/// Every edge is used once in each direction.
bool is_closed(const scene::Mesh& mesh) {
  std::map<std::pair<unsigned, unsigned>, int> uses;
  for (const UVec3& t : mesh.triangles) {
    ++uses[{t.x, t.y}], ++uses[{t.y, t.z}], ++uses[{t.z, t.x}];
  }
  return std::all_of(uses.begin(), uses.end(), [&](const auto& edge) {
    return edge.second == 1 && uses.count({edge.first.second, edge.first.first}) == 1;
  });
}

struct Misses {
  std::atomic<int> intersect{0}, occluded{0};
};

void count_misses(const TriangleScene& scene, std::size_t streams, Misses& misses) {
  scheduling::TileScheduler scheduler;
  scheduler.run(streams, [&](std::size_t stream) {
    RayStream rays;
    HitStream hits;
    OcclusionStream blocked;
    test::fill_random_rays(rays, stream, 0.3F);
    scene.intersect(rays, hits, Coherence::Incoherent);
    scene.occluded(rays, blocked, Coherence::Incoherent);
    for (int i = 0; i < rays.count; ++i) {
      misses.intersect += hits.hit(i) ? 0 : 1;
      misses.occluded += blocked.occluded[i] != 0 ? 0 : 1;
    }
  });
}

TEST(ClosedMesh, NoneOfAMillionRaysEscapes) {
  const scene::Mesh mesh = test::make_bumpy_sphere(5, 0.1F);
  ASSERT_EQ(mesh.triangles.size(), 20'480U);
  ASSERT_TRUE(is_closed(mesh));
  const auto scene = TriangleScene::create(test::scene_of(mesh));
  ASSERT_TRUE(scene) << scene.error().message();
  Misses misses;
  count_misses(**scene, 1'000'000 / kStreamCapacity + 1, misses);
  EXPECT_EQ(misses.intersect.load(), 0);
  EXPECT_EQ(misses.occluded.load(), 0);
}

TEST(ClosedMesh, NoRayEscapesThroughAnInstanceOfIt) {
  const auto scene = TriangleScene::create(
      test::scene_of(test::make_bumpy_sphere(4, 0.1F),
                     {DMat4(1.0), DMat4(DVec4(9, 0, 0, 0), DVec4(0, 9, 0, 0), DVec4(0, 0, 9, 0),
                                        DVec4(0, 0, 0, 1))}),
      {.flat_triangles = 0});
  ASSERT_TRUE(scene);
  Misses misses;
  count_misses(**scene, 400, misses);
  EXPECT_EQ(misses.intersect.load(), 0);
  EXPECT_EQ(misses.occluded.load(), 0);
}

TEST(ClosedMesh, AMissingTriangleLetsRaysOut) {
  // The twin that must fail: were misses never counted, the tests above would say nothing.
  scene::Mesh mesh = test::make_bumpy_sphere(3, 0.1F);
  mesh.triangles.pop_back();
  const auto scene = TriangleScene::create(test::scene_of(mesh));
  ASSERT_TRUE(scene);
  Misses misses;
  count_misses(**scene, 100, misses);
  EXPECT_GT(misses.intersect.load(), 0);
  EXPECT_GT(misses.occluded.load(), 0);
}

}  // namespace
}  // namespace macula::visibility
