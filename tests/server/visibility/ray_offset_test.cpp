#include "server/visibility/ray_offset.h"

#include <gtest/gtest.h>

#include "server/sampling/frame.h"
#include "tests/server/visibility/meshes.h"

namespace macula::visibility {
namespace {

/// A square of two triangles, 2 m a side, in the plane of `frame` through `centre`.
scene::Scene square_at(const Vec3& centre, const Mat3& frame) {
  scene::Mesh mesh;
  for (const auto& [x, y] : {std::pair{-1.0F, -1.0F}, {1.0F, -1.0F}, {1.0F, 1.0F}, {-1.0F, 1.0F}}) {
    mesh.positions.push_back(centre + frame * Vec3{x, y, 0.0F});
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return test::scene_of(std::move(mesh));
}

enum class Start { OnSurface, Offset };

/// Rays that leave the square from points found by a ray of length about 3 m; how many meet it
/// again.
int self_hits(const Vec3& centre, std::uint64_t turn, Start start) {
  const Mat3 frame = sampling::frame_from_normal(
      sampling::uniform_sphere(test::sample_2d(test::SampleKey(4, 0, turn), 0)));
  const auto scene = TriangleScene::create(square_at(centre, frame));
  int hits = 0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const test::SampleKey key(5, turn, i);
    const Vec2 at = 1.8F * test::sample_2d(key, 0) - 0.9F;
    const Vec3 eye = centre + frame * Vec3{0.0F, 0.0F, 3.0F};
    const Vec3 towards = centre + frame * Vec3{at, 0.0F} - eye;
    const auto hit = (*scene)->intersect(Ray{eye, towards});
    if (!hit) continue;
    const Vec3 point = eye + hit->t * towards;
    const Vec3 origin = start == Start::Offset
                            ? offset_ray_origin(point, hit->normal, glm::length(towards))
                            : point;
    const Vec3 away = frame * sampling::cosine_hemisphere(test::sample_2d(key, 2));
    hits += (*scene)->occluded(Ray{origin, away}) ? 1 : 0;
  }
  return hits;
}

TEST(RayOffset, LeavesASurfaceBehindAtEveryScaleOfCoordinates) {
  int without = 0;
  for (const float scale : {0.0F, 1.0F, 100.0F, 10'000.0F}) {
    for (std::uint64_t turn = 0; turn < 20; ++turn) {
      const Vec3 centre = scale * Vec3{1.0F, -0.7F, 0.4F};
      EXPECT_EQ(self_hits(centre, turn, Start::Offset), 0) << "coordinates of " << scale << " m";
      without += self_hits(centre, turn, Start::OnSurface);
    }
  }
  EXPECT_GT(without, 1000);  // the same rays without the offset do meet their own surface
}

TEST(RayOffset, StaysBelowTwoMicrometersPerMeterOfCoordinate) {
  // 16 ulp of at most 2^-23 relative = 1.9e-6, plus half an ulp for the rounding of the sum.
  for (const float size : {0.01F, 1.0F, 50.0F, 1000.0F}) {
    const Vec3 point{size, -0.5F * size, 0.25F * size};
    const Vec3 moved = offset_ray_origin(point, {0.0F, 1.0F, 0.0F});
    EXPECT_GT(moved.y, point.y);
    EXPECT_LE(moved.y - point.y, 2e-6F * size);
    EXPECT_EQ(moved.x, point.x);
    EXPECT_EQ(moved.z, point.z);
  }
}

/// Rays that leave a square of `half_side` m about `centre`, from points some meters from there, as
/// kernels compute them: between the vertices, in double. How many meet it again.
int self_hits_on_wide_square(const Vec3& centre, float half_side, std::uint64_t turn, Start start) {
  const Mat3 frame = sampling::frame_from_normal(
      sampling::uniform_sphere(test::sample_2d(test::SampleKey(14, 0, turn), 0)));
  scene::Scene source = square_at(Vec3{0.0F}, half_side * frame);
  for (Vec3& position : source.meshes[0].positions) position += centre;
  const auto scene = TriangleScene::create(source);
  const scene::Mesh& mesh = source.meshes[0];
  int hits = 0;
  for (std::uint64_t i = 0; i < 100; ++i) {
    const test::SampleKey key(15, turn, i);
    const Vec2 at = 4.0F * test::sample_2d(key, 0) - 2.0F;
    const Vec3 eye = centre + frame * Vec3{0.0F, 0.0F, 3.0F};
    const auto hit = (*scene)->intersect(Ray{eye, centre + frame * Vec3{at, 0.0F} - eye});
    if (!hit) continue;
    const UVec3& corners = mesh.triangles[hit->triangle];
    const DVec3 p0(mesh.positions[corners.x]);
    const DVec3 e1 = DVec3(mesh.positions[corners.y]) - p0;
    const DVec3 e2 = DVec3(mesh.positions[corners.z]) - p0;
    const Vec3 point(p0 + static_cast<double>(hit->u) * e1 + static_cast<double>(hit->v) * e2);
    const auto span = static_cast<float>(std::max(glm::length(e1), glm::length(e2)));
    const Vec3 origin =
        offset_ray_origin(point, hit->normal, 0.0F, start == Start::Offset ? span : 0.0F);
    const Vec3 away = frame * sampling::cosine_hemisphere(test::sample_2d(key, 2));
    hits += (*scene)->occluded(Ray{origin, away}) ? 1 : 0;
  }
  return hits;
}

TEST(RayOffset, CoversTheRoundingOfWideTrianglesWhereTheirPointsHaveSmallCoordinates) {
  int without = 0;
  for (const float half_side : {1.0F, 100.0F, 10'000.0F}) {
    for (std::uint64_t turn = 0; turn < 20; ++turn) {
      const Vec3 origin{0.0F}, far_away{8000.0F, -5000.0F, 3000.0F};
      EXPECT_EQ(self_hits_on_wide_square(origin, half_side, turn, Start::Offset), 0) << half_side;
      EXPECT_EQ(self_hits_on_wide_square(far_away, half_side, turn, Start::Offset), 0) << half_side;
      without += self_hits_on_wide_square(origin, half_side, turn, Start::OnSurface);
    }
  }
  EXPECT_GT(without, 500);  // by the points' coordinates alone
}

}  // namespace
}  // namespace macula::visibility
