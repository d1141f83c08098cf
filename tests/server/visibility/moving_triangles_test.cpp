#include "server/visibility/moving_triangles.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/server/visibility/meshes.h"

namespace macula::visibility {
namespace {

using scene::SceneTime;

constexpr double kTurn = 2.0 * std::numbers::pi;

SceneTime at_s(double seconds) {
  return {units::from_s(seconds)};
}

/// Once round the Y axis in four seconds.
scene::Joint carousel() {
  scene::Joint joint;
  for (int quarter = 0; quarter <= 4; ++quarter) {
    joint.rotations.times_s.push_back(quarter);
    joint.rotations.values.push_back(glm::angleAxis(kTurn * quarter / 4.0, DVec3{0, 1, 0}));
  }
  joint.period = std::chrono::seconds{4};
  return joint;
}

/// A card of 1 m in the plane x = 0, front towards -x.
scene::Mesh card() {
  scene::Mesh mesh;
  mesh.positions = {{0, -0.5F, -0.5F}, {0, -0.5F, 0.5F}, {0, 0.5F, 0.5F}, {0, 0.5F, -0.5F}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// A mesh over a second, from one shape to another and back in the next.
scene::Mesh changing(scene::Mesh mesh, const std::vector<Vec3>& other) {
  mesh.deformation.times_s = {0.0, 1.0, 2.0};
  mesh.deformation.positions = {mesh.positions, other, mesh.positions};
  mesh.deformation.period = std::chrono::seconds{2};
  return mesh;
}

/// A bumpy ball that leans, swells and sinks.
scene::Mesh changing_ball() {
  scene::Mesh ball = test::make_bumpy_sphere(4, 0.1F);
  std::vector<Vec3> other = ball.positions;
  for (Vec3& p : other) {
    p = {p.x * (1.3F + 0.5F * p.y) + 0.4F * std::sin(5.0F * p.z), 0.6F * p.y - 0.3F, 1.4F * p.z};
  }
  return changing(std::move(ball), other);
}

struct Stage {
  scene::Scene scene;
  scene::MovingParts moving;
  std::unique_ptr<MovingTriangles> triangles;

  explicit Stage(scene::Scene made, const Options& options = {})
      : scene(std::move(made)), moving(scene::moving_parts(scene)) {
    triangles =
        *MovingTriangles::create(scene, moving, scene::pose_at(scene, SceneTime{}), options);
  }
  scene::ScenePose pose(double seconds) const { return scene::pose_at(scene, at_s(seconds)); }
  std::shared_ptr<TriangleScene> make(double seconds) const {
    return *triangles->make(pose(seconds));
  }
  void move(TriangleScene& moved, double seconds) const {
    ASSERT_TRUE(triangles->move(moved, pose(seconds)));
  }
};

struct Differences {
  int surfaces = 0;  ///< rays that meet other triangles, or only one of them meets any
  int bits = 0;      ///< those and rays whose hits differ in t or normal at all
  float t = 0.0F;    ///< largest, of rays that meet the same triangle
};
/// Over 256 x `streams` rays.
Differences compare(const TriangleScene& a, const TriangleScene& b, int streams, float spread) {
  Differences differ;
  RayStream rays;
  HitStream hits_a, hits_b;
  for (int stream = 0; stream < streams; ++stream) {
    test::fill_random_rays(rays, static_cast<std::uint64_t>(stream), spread);
    a.intersect(rays, hits_a, Coherence::Incoherent);
    b.intersect(rays, hits_b, Coherence::Incoherent);
    for (int i = 0; i < rays.count; ++i) {
      const bool both = hits_a.hit(i) && hits_b.hit(i);
      const bool same_surface = hits_a.instance[i] == hits_b.instance[i] &&
                                (!both || hits_a.triangle[i] == hits_b.triangle[i]);
      const bool same_bits =
          same_surface &&
          (!both || (hits_a.t[i] == hits_b.t[i] && hits_a.normal(i) == hits_b.normal(i)));
      differ.surfaces += same_surface ? 0 : 1;
      differ.bits += same_bits ? 0 : 1;
      if (same_surface && both) differ.t = std::max(differ.t, std::abs(hits_a.t[i] - hits_b.t[i]));
    }
  }
  return differ;
}

TEST(MovingTriangles, AKeyframedInstanceIsHitWhereTheFormulaSays) {
  scene::Scene scene = test::scene_of(card());
  scene.joints = {carousel()};
  scene.instances = {{0, glm::translate(DMat4{1.0}, DVec3{2.0, 0.0, 0.0}), 0}};
  const Stage stage(std::move(scene));
  const auto triangles = stage.make(0.0);
  for (const double t : {0.0, 0.3, 1.0, 2.6, 3.999, 4.0, 77.7, -1.2}) {
    stage.move(*triangles, t);
    const double angle = kTurn * t / 4.0;
    const Vec3 outwards(std::cos(angle), 0.0, -std::sin(angle));
    const auto hit = triangles->intersect(Ray{Vec3{0.0F}, outwards});
    ASSERT_TRUE(hit) << t;
    EXPECT_NEAR(hit->t, 2.0F, 1e-5F);
    EXPECT_EQ(hit->instance, 0U);
    EXPECT_NEAR(glm::dot(hit->normal, outwards), -1.0F, 1e-5F) << "the front faces the axis";
    EXPECT_FALSE(triangles->intersect(Ray{Vec3{0.0F}, -outwards})) << t;
    EXPECT_TRUE(triangles->occluded(Ray{Vec3{0.0F}, outwards}));
  }
}

TEST(MovingTriangles, ARefitMeetsWhatAFullRebuildMeets) {
  const Stage stage(test::scene_of(changing_ball()));
  const auto refitted = stage.make(0.0);
  int stale = 0;
  for (const double t : {0.35, 1.0, 1.8}) {
    const auto rebuilt = *TriangleScene::create(stage.scene, stage.pose(t));
    // Must-fail twin: with the vertices of before, the same comparison sees it.
    stale += compare(*refitted, *rebuilt, 10, 2.0F).surfaces;
    stage.move(*refitted, t);
    // 1e5 rays over the three times. A ray through an edge may name either triangle.
    const Differences differ = compare(*refitted, *rebuilt, 130, 2.0F);
    EXPECT_LE(differ.surfaces, 2) << t;
    EXPECT_LE(differ.t, 1e-5F) << t;
  }
  EXPECT_GT(stale, 1000);
}

TEST(MovingTriangles, TheWayToAPoseLeavesNoTrace) {
  scene::Scene scene = test::scene_of(changing_ball());
  scene.meshes.push_back(test::make_triangle_soup(300));
  scene.joints = {carousel()};
  for (int i = 0; i < 40; ++i) {
    const DVec3 place{2.0 + 0.1 * i, 0.05 * i, 0.0};
    scene.instances.push_back({1, glm::translate(DMat4{1.0}, place), 0});
  }
  const Stage stage(std::move(scene));
  const auto direct = stage.make(1.37), roundabout = stage.make(0.2);
  for (const double t : {3.0, 0.9, 250.0, 1.37}) stage.move(*roundabout, t);
  EXPECT_EQ(compare(*direct, *roundabout, 60, 4.0F).bits, 0);
}

/// A large still ball, shared still copies of a soup, and one soup that is carried about.
scene::Scene mixed() {
  scene::Scene scene = test::scene_of(test::make_bumpy_sphere(4, 0.1F));
  scene.meshes.push_back(test::make_triangle_soup(300));
  scene.joints = {carousel()};
  for (int i = 0; i < 5; ++i) {
    scene.instances.push_back({1, glm::translate(DMat4{1.0}, DVec3{-3.0 + i, 2.0, 1.0})});
  }
  scene.instances.push_back({1, glm::translate(DMat4{1.0}, DVec3{3.0, 0.0, 0.0}), 0});
  return scene;
}

TEST(MovingTriangles, HitsNameTheScenesOwnInstancesHoweverTheyAreStored) {
  // flat_triangles = 0: copies of the soup share one structure; the ball is flattened in any case.
  for (const std::size_t flat : {std::size_t{0}, std::size_t{2'000'000}}) {
    const Options options{.flat_triangles = flat};
    const Stage stage(mixed(), options);
    const auto moved = stage.make(0.0);
    stage.move(*moved, 2.5);
    const auto rebuilt = *TriangleScene::create(stage.scene, stage.pose(2.5), options);
    RayStream rays;
    HitStream ours, theirs;
    int differ = 0, on_moving = 0;
    for (std::uint64_t stream = 0; stream < 40; ++stream) {
      test::fill_random_rays(rays, stream, 4.0F);
      moved->intersect(rays, ours, Coherence::Incoherent);
      rebuilt->intersect(rays, theirs, Coherence::Incoherent);
      for (int i = 0; i < rays.count; ++i) {
        const bool same = ours.instance[i] == theirs.instance[i] &&
                          (!ours.hit(i) || ours.triangle[i] == theirs.triangle[i]);
        differ += same ? 0 : 1;  // within rounding of an edge: transforms are float in instances
        on_moving += ours.instance[i] == 6 ? 1 : 0;
        if (!same || !ours.hit(i)) continue;
        EXPECT_NEAR(ours.t[i], theirs.t[i], 1e-4F * theirs.t[i]);
        EXPECT_NEAR(glm::dot(ours.normal(i), theirs.normal(i)), 1.0F, 1e-4F);
      }
    }
    EXPECT_LE(differ, 5);
    EXPECT_GT(on_moving, 50);
  }
}

TEST(MovingTriangles, AnInstanceScaledToNothingIsNotThereAndComesBack) {
  scene::Scene scene = test::scene_of(card());
  scene::Joint joint;
  joint.scales = {scene::Interpolation::Step, {0.0, 1.0, 2.0}, {DVec3{1}, DVec3{0}, DVec3{1}}};
  scene.joints = {joint};
  scene.instances = {{0, glm::translate(DMat4{1.0}, DVec3{2.0, 0.0, 0.0}), 0}};
  const Stage stage(std::move(scene));
  const auto triangles = stage.make(0.5);
  const Ray ahead{Vec3{0.0F}, Vec3{1.0F, 0.0F, 0.0F}};
  EXPECT_TRUE(triangles->occluded(ahead));
  stage.move(*triangles, 1.5);
  EXPECT_FALSE(triangles->occluded(ahead));
  stage.move(*triangles, 2.5);
  EXPECT_TRUE(triangles->occluded(ahead));
}

TEST(MovingTriangles, ASceneWithoutTrianglesHasNothingToMeet) {
  scene::Scene empty;
  empty.name = "empty";
  const Stage stage(std::move(empty));
  const auto triangles = stage.make(1.0);
  EXPECT_FALSE(triangles->intersect(Ray{Vec3{0.0F}, Vec3{1.0F, 0.0F, 0.0F}}));
  EXPECT_EQ(triangles->packet_width(), 0);
}

}  // namespace
}  // namespace macula::visibility
