// What must not happen for odd scenes and odd eyes: a hang, a number that is none, a chance
// picture.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/server/sdf/tracing.h"

namespace macula::sdf {
namespace {

void expect_defined(const std::vector<Hit>& hits) {
  for (const Hit& hit : hits) {
    ASSERT_FALSE(std::isnan(hit.t));
    ASSERT_TRUE(math::is_finite(hit.normal));
    ASSERT_TRUE(math::is_finite(hit.direction));
    if (hit.status == RayStatus::Hit) {
      ASSERT_NEAR(glm::length(hit.normal), 1.0F, 1e-4F);
      ASSERT_GE(hit.material, 0);
    }
  }
}

class Extremes : public testing::TestWithParam<Method> {
 protected:
  TraceOptions options() const {
    TraceOptions result;
    result.method = GetParam();
    return result;
  }
};

TEST_P(Extremes, AnEyeInASolidHitsAtZeroWithAFlag) {
  const Field field = scene_of(R"({"type": "sphere", "radius": 2})");
  const Traced traced =
      trace_picture(compile(field, 0.0, DVec3{0.5}), Pose{}, ordinary_grid(40, 30), options());
  expect_defined(traced.hits);
  EXPECT_EQ(traced.counts.inside, traced.hits.size());
  for (const Hit& hit : traced.hits) {
    ASSERT_EQ(hit.status, RayStatus::Inside);
    ASSERT_EQ(hit.t, 0.0F);
  }
}

TEST_P(Extremes, AnExpressionWithANumberThatIsNoneIsRefused) {
  Field field = scene_of(R"({"type": "union", "of": [
      {"type": "plane", "normal": [0, 1, 0]},
      {"type": "sphere", "radius": 1, "at": [0, 1, -4]}]})");
  field.nodes[1].parameters[0].value = DVec3{std::nan("")};
  const Program program = compile(field, 0.0, DVec3{0.0});
  const PixelGrid grid = ordinary_grid(16, 16);
  const auto tracer = Tracer::create(program, DMat3{1.0}, grid, options());
  ASSERT_FALSE(tracer);
  EXPECT_NE(tracer.error().message().find("not finite"), std::string::npos);
}

TEST_P(Extremes, ScalesOfAMillionthAndAMillionGiveTheSamePicture) {
  const std::string scene = R"({"type": "union", "scale": %, "of": [
      {"type": "plane", "normal": [0, 1, 0], "at": [0, -1, 0]},
      {"type": "torus", "radius": 1, "tube_radius": 0.3},
      {"type": "noise", "amplitude": 0.1, "cell": 0.4, "at": [0, 0.8, 0],
       "of": {"type": "box", "half_size": 0.5}}]})";
  std::vector<std::vector<Hit>> pictures;
  const std::vector<double> scales{1.0, 1e-6, 1e6};
  for (const double scale : scales) {
    std::string text = scene;
    text.replace(text.find('%'), 1, std::to_string(scale));
    Field field = scene_of(text);
    field.far_m = 100.0 * scale;
    TraceOptions exact = options();
    exact.hit_pixels = 0.0F;
    exact.hit_m = static_cast<float>(1e-4 * scale);
    const Pose pose = math::look_at(scale * DVec3{2.0, 2.0, 4.0}, DVec3{0.0}, {0.0, 1.0, 0.0});
    pictures.push_back(
        trace_picture(compile(field, 0.0, pose.position), pose, ordinary_grid(120, 90), exact)
            .hits);
  }
  for (std::size_t other = 1; other < scales.size(); ++other) {
    std::size_t differ = 0;
    for (std::size_t i = 0; i < pictures[0].size(); ++i) {
      const Hit &a = pictures[0][i], &b = pictures[other][i];
      const bool same = a.status == b.status && a.material == b.material &&
                        (a.status != RayStatus::Hit ||
                         std::abs(b.t / static_cast<float>(scales[other]) - a.t) < 1e-3F * a.t);
      differ += same ? 0 : 1;
    }
    EXPECT_LT(differ, pictures[0].size() / 500) << scales[other];
  }
}

TEST_P(Extremes, AnEyeFarFromTheOriginSeesTheSamePicture) {
  std::vector<std::vector<Hit>> pictures;
  for (const char* at : {"[0, 0, 0]", "[1e5, 0, -1e5]"}) {
    const Field field = scene_of(std::string(R"({"type": "union", "at": )") + at + R"(, "of": [
        {"type": "torus", "radius": 1, "tube_radius": 0.3, "rotate_deg": [60, 10, 0]},
        {"type": "box", "half_size": [0.3, 2, 0.3]}]})");
    const Pose pose = math::look_at(field.nodes.back().at.value + DVec3{2.0, 2.0, 4.0},
                                    field.nodes.back().at.value, {0.0, 1.0, 0.0});
    pictures.push_back(
        trace_picture(compile(field, 0.0, pose.position), pose, ordinary_grid(160, 120), options())
            .hits);
  }
  for (std::size_t i = 0; i < pictures[0].size(); ++i) {
    ASSERT_EQ(pictures[0][i].status, pictures[1][i].status);
    ASSERT_EQ(pictures[0][i].t, pictures[1][i].t);
  }
}

TEST_P(Extremes, AViewOf179DegreesIsDefinedAndRight) {
  const Field field =
      scene_of(R"({"type": "shell", "thickness": 0.1, "of": {"type": "sphere", "radius": 5}})");
  const Traced traced = trace_picture(compile(field, 0.0, DVec3{0.0}), Pose{},
                                      ordinary_grid(65, 33, Degrees{179.0}), options());
  expect_defined(traced.hits);
  for (const Hit& hit : traced.hits) {
    ASSERT_EQ(hit.status, RayStatus::Hit);
    ASSERT_NEAR(hit.t, 4.9F, 1e-3F);
  }
}

TEST_P(Extremes, PicturesOfOnePixelAndOfOneRowAreTraced) {
  const Field field = scene_of(R"({"type": "sphere", "radius": 1})");
  const Program program = compile(field, 0.0, {0.0, 0.0, 3.0});
  EXPECT_EQ(trace_picture(program, Pose{}, ordinary_grid(1, 1), options()).hits[0].status,
            RayStatus::Hit);
  expect_defined(trace_picture(program, Pose{}, ordinary_grid(300, 1), options()).hits);
}

TEST_P(Extremes, ASceneWithoutAnEndIsTracedToTheFarthestNumber) {
  Field field = scene_of(R"({"type": "sphere", "radius": 1})");
  field.far_m = 1e12;
  const Traced traced =
      trace_picture(compile(field, 0.0, {0.0, 0.0, 3.0}), Pose{}, ordinary_grid(64, 48), options());
  expect_defined(traced.hits);
  EXPECT_EQ(traced.counts.capped, 0U);
}

INSTANTIATE_TEST_SUITE_P(Sdf, Extremes,
                         testing::Values(Method::Full, Method::FullBest, Method::Cones));

}  // namespace
}  // namespace macula::sdf
