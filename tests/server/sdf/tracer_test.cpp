#include "server/sdf/tracer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "tests/server/sdf/tracing.h"

namespace macula::sdf {
namespace {

TraceOptions exactly(Method method) {
  TraceOptions options;
  options.method = method;
  options.hit_pixels = 0.0F;
  options.hit_m = 1e-4F;
  options.max_steps = 2000;
  return options;
}

// |o + t d|^2 = r^2 for a sphere of radius r around the origin, nearer root.
std::optional<double> sphere_t(const DVec3& eye, const DVec3& direction, double radius) {
  const double along = glm::dot(eye, direction);
  const double rest = along * along - glm::dot(eye, eye) + radius * radius;
  if (rest < 0.0) return std::nullopt;
  return -along - std::sqrt(rest);
}

class EachMethod : public testing::TestWithParam<Method> {};

TEST_P(EachMethod, MeetsASphereWhereItsEquationSays) {
  const Field field = scene_of(R"({"type": "sphere", "radius": 1.5})");
  const Pose pose = math::look_at({0.5, 1.0, 6.0}, DVec3{0.0}, {0.0, 1.0, 0.0});
  const Program program = compile(field, 0.0, pose.position);
  const Traced traced = trace_picture(program, pose, grid_of(many(30000)), exactly(GetParam()));
  int hits = 0;
  for (const Hit& hit : traced.hits) {
    const DVec3 direction(hit.direction);
    const auto expected = sphere_t(pose.position, direction, 1.5);
    // Rays that pass within the hit distance of the silhouette may go either way.
    const double miss_m = glm::length(glm::cross(pose.position, direction)) - 1.5;
    if (std::abs(miss_m) < 2e-4) continue;
    ASSERT_EQ(hit.status == RayStatus::Hit, expected.has_value());
    if (!expected || miss_m > -0.02) continue;
    ++hits;
    ASSERT_NEAR(hit.t / *expected, 1.0, 1e-5);
    const DVec3 normal = (pose.position + *expected * direction) / 1.5;
    ASSERT_GT(glm::dot(DVec3(hit.normal), normal), 0.9999);
  }
  EXPECT_GT(hits, 3000);
}

/// Asked exactly on the surface, gradients of what measures the way to its nearest point were made
/// of roundings: arches and shafts of `columns` showed specks.
TEST_P(EachMethod, NormalsOfRoundThingsPointAwayFromTheirAxis) {
  for (const char* node :
       {R"({"type": "cylinder", "radius": 1, "half_height": 50})",
        R"({"type": "cone", "bottom_radius": 1, "top_radius": 1, "half_height": 50})"}) {
    const Field field = scene_of(node);
    const Pose pose = math::look_at({3.0, 0.7, 7.0}, DVec3{0.0}, {0.0, 1.0, 0.0});
    const Program program = compile(field, 0.0, pose.position);
    TraceOptions options;
    options.method = GetParam();
    const Traced traced =
        trace_picture(program, pose, ordinary_grid(300, 200, Degrees{12.0}), options);
    int hits = 0;
    for (const Hit& hit : traced.hits) {
      if (hit.status != RayStatus::Hit) continue;
      DVec3 away = pose.position + double{hit.t} * DVec3(hit.direction);
      away.y = 0.0;
      ++hits;
      ASSERT_GT(glm::dot(DVec3(hit.normal), glm::normalize(away)), 0.999) << node;
    }
    EXPECT_GT(hits, 20000) << node;
  }
}

TEST_P(EachMethod, MeetsAPlaneWhereItsEquationSays) {
  const Field field = scene_of(R"({"type": "plane", "normal": [0, 1, 0]})");
  const Pose pose = math::look_at({0.0, 2.0, 0.0}, {0.0, 0.0, -4.0}, {0.0, 1.0, 0.0});
  const Program program = compile(field, 0.0, pose.position);
  const Traced traced = trace_picture(program, pose, grid_of(many(30000)), exactly(GetParam()));
  for (const Hit& hit : traced.hits) {
    const double expected = 2.0 / -hit.direction.y;
    const bool below = hit.direction.y < -0.1F;
    if (below) {
      ASSERT_NEAR(hit.t / expected, 1.0, 1e-5);
    }
    if (hit.direction.y > 0.0F) {
      ASSERT_EQ(hit.status, RayStatus::Miss);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sdf, EachMethod,
                         testing::Values(Method::Full, Method::FullBest, Method::Cones));

/// Tiles of at most `side` a side over a grid, last to first.
std::vector<image::Rect> tiles_of(const PixelGrid& grid, int side) {
  std::vector<image::Rect> tiles;
  for (int y = 0; y < grid.height(); y += side)
    for (int x = 0; x < grid.width(); x += side)
      tiles.push_back({x, y, std::min(side, grid.width() - x), std::min(side, grid.height() - y)});
  std::reverse(tiles.begin(), tiles.end());
  return tiles;
}

// What is pruned depends on the tile; what a ray meets must not. It did: a hit was moved onto the
// surface only where the next slab of the tile was not in the way.
TEST(Tracer, GivesTheSameHitsForAnyTiles) {
  for (const char* name : {"primitives", "columns", "temple"}) {
    const Field field = built_in(name);
    const Pose pose = field.pose_of(field.cameras.front(), 1.0);
    const Program program = compile(field, 1.0, pose.position);
    const PixelGrid grid = ordinary_grid(100, 75);
    for (const Method method : {Method::Full, Method::FullBest}) {
      TraceOptions options;
      options.method = method;
      const Traced whole = trace_picture(program, pose, grid, options);
      const auto tracer = Tracer::create(program, glm::mat3_cast(pose.rotation), grid, options);
      ASSERT_TRUE(tracer);
      TraceWorkspace workspace;
      std::size_t seen = 0;
      for (const image::Rect& tile : tiles_of(grid, 23)) {
        tracer->trace(tile, nullptr, workspace, [&](const HitBlock& block) {
          for (const Hit& hit : block.hits) {
            ++seen;
            const Hit& same = whole.hits[static_cast<std::size_t>(hit.y * 100 + hit.x)];
            ASSERT_EQ(hit.status, same.status);
            ASSERT_EQ(hit.t, same.t);
            ASSERT_EQ(hit.normal, same.normal);
          }
        });
      }
      EXPECT_EQ(seen, whole.hits.size());
    }
  }
}

TEST(Tracer, GivesTheSameBitsAgainAndUnderAMask) {
  const Field field = built_in("primitives");
  const Pose pose = field.pose_of(field.cameras.front(), 1.0);
  const Program program = compile(field, 1.0, pose.position);
  const PixelGrid grid = ordinary_grid(200, 150);
  const Traced a = trace_picture(program, pose, grid, {});
  const Traced b = trace_picture(program, pose, grid, {});
  ASSERT_EQ(a.hits.size(), b.hits.size());
  for (std::size_t i = 0; i < a.hits.size(); ++i) ASSERT_EQ(a.hits[i].t, b.hits[i].t);
  EXPECT_EQ(a.counts.evaluations(), b.counts.evaluations());

  image::Plane<std::uint8_t> mask(grid.width(), grid.height());
  std::size_t wanted = 0;
  for (std::size_t i = 0; i < mask.size(); ++i)
    wanted += mask.pixels()[i] = i % 7 == 0 && i / 200 > 40 ? 1 : 0;
  const Result<Tracer> tracer =
      Tracer::create(program, glm::mat3_cast(pose.rotation), grid, TraceOptions{});
  ASSERT_TRUE(tracer);
  TraceWorkspace workspace;
  std::size_t seen = 0, evaluations = 0;
  for (const image::Rect& tile : tiles_of(grid, kTileSide)) {
    const TraceCounts counts = tracer->trace(tile, &mask, workspace, [&](const HitBlock& block) {
      for (const Hit& hit : block.hits) {
        ++seen;
        const Hit& same = a.hits[static_cast<std::size_t>(hit.y * 200 + hit.x)];
        ASSERT_EQ(hit.status, same.status);
        ASSERT_EQ(hit.t, same.t);
      }
    });
    evaluations += counts.evaluations();
  }
  EXPECT_EQ(seen, wanted);
  EXPECT_LT(evaluations, a.counts.evaluations() / 2);
}

TEST(Tracer, GivesFirstLevelsAndSamplesTheSameHits) {
  const Field field = built_in("columns");
  const Pose pose = field.pose_of(field.cameras.front(), 0.0);
  const Program program = compile(field, 0.0, pose.position);
  const PixelGrid grid = ordinary_grid(120, 90);
  for (const int samples : {1, 4, 16}) {
    TraceOptions options;
    options.samples = samples;
    const Traced all = trace_picture(program, pose, grid, options);
    ASSERT_EQ(all.hits.size(), 120U * 90U * static_cast<std::size_t>(samples));
    for (const std::vector<int>& levels : {std::vector<int>{}, {32, 4}, {1}}) {
      options.levels = levels;
      const Traced other = trace_picture(program, pose, grid, options);
      EXPECT_EQ(differences(all.hits, other.hits), 0U);
    }
  }
}

TEST(Tracer, RefusesOptionsOutOfRange) {
  const Program program = compile(scene_of(R"({"type": "sphere", "radius": 1})"), 0.0, DVec3{0.0});
  const PixelGrid grid = ordinary_grid(8, 8);
  const auto refused = [&](const TraceOptions& options) {
    return !Tracer::create(program, DMat3{1.0}, grid, options).has_value();
  };
  EXPECT_TRUE(refused({.levels = {4, 8}}));
  EXPECT_TRUE(refused({.levels = {12}}));
  EXPECT_TRUE(refused({.samples = 17}));
  EXPECT_TRUE(refused({.hit_pixels = 0.0F}));
  EXPECT_TRUE(refused({.max_steps = 0}));
  EXPECT_FALSE(refused({}));
}

}  // namespace
}  // namespace macula::sdf
