#include "server/sdf/paper_pyramid.h"

#include <gtest/gtest.h>

#include "tests/server/sdf/tracing.h"

namespace macula::sdf {
namespace {

struct PaperPicture {
  std::vector<Hit> hits;
  TraceCounts counts;
};

PaperPicture trace_paper(const Program& program, const Pose& pose, const PixelGrid& grid,
                         const PaperOptions& options) {
  auto pyramid = PaperPyramid::create(program, glm::mat3_cast(pose.rotation), grid, options);
  if (!pyramid) ADD_FAILURE() << pyramid.error().message();
  PaperPicture result;
  result.hits.resize(static_cast<std::size_t>(grid.width() * grid.height()));
  TraceWorkspace workspace;
  for (int level = 0; level < PaperPyramid::kLevels; ++level) {
    const PixelGrid& cells = pyramid->grid(level);
    for (int y = 0; y < cells.height(); y += kTileSide) {
      for (int x = 0; x < cells.width(); x += kTileSide) {
        const image::Rect tile{x, y, std::min(kTileSide, cells.width() - x),
                               std::min(kTileSide, cells.height() - y)};
        result.counts += pyramid->trace(level, tile, workspace, [&](const HitBlock& block) {
          for (const Hit& hit : block.hits)
            result.hits[static_cast<std::size_t>(hit.y * grid.width() + hit.x)] = hit;
        });
      }
    }
  }
  return result;
}

TraceOptions full() {
  TraceOptions options;
  options.method = Method::Full;
  return options;
}

std::size_t wrong_hits(const std::vector<Hit>& truth, const std::vector<Hit>& found) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const bool same = truth[i].status == found[i].status &&
                      (truth[i].status != RayStatus::Hit ||
                       std::abs(truth[i].t - found[i].t) < 0.01F * truth[i].t);
    wrong += same ? 0 : 1;
  }
  return wrong;
}

class ThinPoles : public testing::Test {
 protected:
  // Poles thinner than the gaps between rays of the coarsest level: on this grid and no finer one.
  Field field = scene_of(R"({"type": "repeat", "period": [0.5, 0, 0], "first": [-8, 0, 0],
    "last": [8, 0, 0], "of": {"type": "cylinder", "radius": 0.012, "half_height": 2}})");
  Pose pose = math::look_at({0.1, 0.3, 4.0}, DVec3{0.0}, {0.0, 1.0, 0.0});
  Program program = compile(field, 0.0, pose.position);
  PixelGrid grid = grid_of(76800);
};

TEST_F(ThinPoles, ArePassedByThePrintedMethodAndMetByCones) {
  const Traced truth = trace_picture(program, pose, grid, full());
  const Traced cones = trace_picture(program, pose, grid, TraceOptions{});
  const PaperPicture printed = trace_paper(program, pose, grid, {});
  const auto pole_pixels = std::count_if(truth.hits.begin(), truth.hits.end(), [](const Hit& hit) {
    return hit.status == RayStatus::Hit;
  });
  ASSERT_GT(pole_pixels, 2000);
  EXPECT_EQ(differences(truth.hits, cones.hits), 0U);
  EXPECT_GT(wrong_hits(truth.hits, printed.hits), truth.hits.size() / 100);
}

TEST_F(ThinPoles, AreMissedLessByALargerFilterAtMoreEvaluations) {
  const Traced truth = trace_picture(program, pose, grid, full());
  std::size_t wrong_before = truth.hits.size();
  std::uint64_t evaluations_before = 0;
  for (const int filter : {1, 3, 5}) {
    const PaperPicture printed = trace_paper(program, pose, grid, {.filter = filter});
    const std::size_t wrong = wrong_hits(truth.hits, printed.hits);
    EXPECT_LT(wrong, wrong_before) << filter;
    EXPECT_GT(printed.counts.ray_evaluations, evaluations_before) << filter;
    wrong_before = wrong;
    evaluations_before = printed.counts.ray_evaluations;
  }
}

TEST(PaperPyramid, HasLevelsOfASixteenthAQuarterAndAllOfTheCells) {
  const Field field = scene_of(R"({"type": "sphere", "radius": 1})");
  const Program program = compile(field, 0.0, {0.0, 0.0, 5.0});
  const PixelGrid grid = ordinary_grid(160, 120);
  const auto pyramid = PaperPyramid::create(program, DMat3{1.0}, grid, {});
  ASSERT_TRUE(pyramid);
  EXPECT_EQ(pyramid->grid(0).width(), 40);
  EXPECT_EQ(pyramid->grid(0).height(), 30);
  EXPECT_EQ(pyramid->grid(1).width(), 80);
  EXPECT_EQ(pyramid->grid(2), grid);
}

TEST(PaperPyramid, RefusesAFilterItDoesNotKnow) {
  const Field field = scene_of(R"({"type": "sphere", "radius": 1})");
  const Program program = compile(field, 0.0, {0.0, 0.0, 5.0});
  const auto pyramid =
      PaperPyramid::create(program, DMat3{1.0}, ordinary_grid(16, 16), {.filter = 4});
  ASSERT_FALSE(pyramid);
  EXPECT_NE(pyramid.error().message().find("1, 3 or 5"), std::string::npos);
}

}  // namespace
}  // namespace macula::sdf
