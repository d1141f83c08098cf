// The claim of the room: cones, pruning and relaxed steps find the same first hits as plain sphere
// tracing with the whole program, on scenes made to break that.
#include <gtest/gtest.h>

#include <cmath>

#include "server/sdf/evaluate.h"
#include "server/sdf/tape.h"
#include "shared/math/hash.h"
#include "tests/server/sdf/tracing.h"

namespace macula::sdf {
namespace {

constexpr float kHit = 1e-4F;  // m

struct HardScene {
  const char* name;
  Field field;
  DVec3 eye, target;
};

std::string menger(int levels) {
  // A cube minus a cross of square bars, three times as fine and as many at every level.
  std::string crosses;
  double size = 1.0;
  for (int level = 0; level < levels; ++level, size /= 3.0) {
    const std::string bar = std::to_string(size / 3.0), period = std::to_string(2.0 * size);
    const std::string cross = R"({"type": "union", "of": [
        {"type": "box", "half_size": [9, )" +
                              bar + ", " + bar + R"(]},
        {"type": "box", "half_size": [)" +
                              bar + ", 9, " + bar + R"(]},
        {"type": "box", "half_size": [)" +
                              bar + ", " + bar + R"(, 9]}]})";
    crosses +=
        R"(, {"type": "repeat", "alternate": 1, "period": )" + period + R"(, "of": )" + cross + "}";
  }
  return R"({"type": "difference", "of": [{"type": "box", "half_size": 1})" + crosses + "]}";
}

std::vector<HardScene> hard_scenes() {
  std::vector<HardScene> scenes;
  scenes.push_back({"poles",
                    scene_of(R"({"type": "union", "of": [
      {"type": "plane", "normal": [0, 1, 0], "at": [0, -2, 0]},
      {"type": "repeat", "period": [0.5, 0, 0.7], "first": [-8, 0, -3], "last": [8, 0, 3],
       "of": {"type": "cylinder", "radius": 0.01, "half_height": 2}}]})"),
                    {0.1, 0.3, 6.0},
                    {0.0, 0.0, 0.0}});
  scenes.push_back({"tori",
                    scene_of(R"({"type": "union", "of": [
      {"type": "torus", "radius": 1, "tube_radius": 0.02},
      {"type": "torus", "radius": 0.9, "tube_radius": 0.1, "at": [0.9, 0, 0], "rotate_deg": [90, 0, 0]},
      {"type": "torus", "radius": 0.7, "tube_radius": 0.03, "at": [0, 0.4, 0], "rotate_deg": [30, 20, 70]},
      {"type": "shell", "thickness": 0.01, "at": [-1.2, 0, 0], "of": {"type": "sphere", "radius": 0.5}}]})"),
                    {0.4, 1.6, 3.2},
                    {0.0, 0.0, 0.0}});
  scenes.push_back({"menger", scene_of(menger(3)), {1.7, 1.4, 2.6}, {0.0, 0.0, 0.0}});
  scenes.push_back({"smooth",
                    scene_of(R"({"type": "union", "smooth": 0.4, "of": [
      {"type": "sphere", "radius": 0.7},
      {"type": "capsule", "from": [-2, 0, 0], "to": [2, 0.3, 0], "radius": 0.06},
      {"type": "box", "half_size": [0.3, 0.8, 0.3], "at": [1.2, 0, 0.4], "rotate_deg": [10, 30, 0]},
      {"type": "twist", "deg_per_m": 120, "within_radius": 0.5, "at": [-1.2, 0, 0],
       "of": {"type": "box", "half_size": [0.25, 0.9, 0.25]}},
      {"type": "noise", "amplitude": 0.1, "cell": 0.5, "at": [0, -0.9, 0],
       "of": {"type": "ellipsoid", "radii": [1.5, 0.3, 0.8]}}]})"),
                    {0.3, 1.2, 3.5},
                    {0.0, 0.0, 0.0}});
  for (const char* name : {"primitives", "columns", "temple"}) {
    Field field = built_in(name);
    const Camera camera = field.cameras.front();
    scenes.push_back({name, field, camera.eye.value, camera.target.value});
  }
  return scenes;
}

/// What the whole field is along a ray, at points as far apart as half the hit distance but at most
/// 20000 of them.
float least_between(const Tape& tape, const Vec3& direction, float from, float to) {
  const int count = std::clamp(static_cast<int>((to - from) / (0.5F * kHit)), 2, 20000);
  Registers registers;
  PointBatch points{};
  DistanceBatch found{};
  float least = std::numeric_limits<float>::infinity();
  for (int first = 0; first <= count; first += static_cast<int>(kBatch)) {
    const int here = std::min(static_cast<int>(kBatch), count + 1 - first);
    for (int i = 0; i < here; ++i) {
      const float share = static_cast<float>(first + i) / static_cast<float>(count);
      points.set(static_cast<std::size_t>(i), (from + share * (to - from)) * direction);
    }
    evaluate(tape, points, static_cast<std::size_t>(here), registers, found);
    least = std::min(least, *std::min_element(found.at, found.at + here));
  }
  return least;
}

struct Comparison {
  int grazing = 0;  ///< differ, but pass within two hit distances of a surface without crossing it
  int wrong = 0;    ///< differ for no such reason
};

Comparison compare(const Program& program, const std::vector<Hit>& truth,
                   const std::vector<Hit>& found) {
  const Tape tape = make_tape(program);
  Comparison result;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const float a = std::min(truth[i].t, program.far_m), b = std::min(found[i].t, program.far_m);
    const bool rounding = std::abs(a - b) <= 2.0F * kHit + 1e-6F * a;
    if (truth[i].status == found[i].status && rounding) continue;
    // The nearer one stopped at something that the other passed: it must be a near miss.
    const float nearer = std::min(a, b), farther = std::max(a, b);
    const float end = std::max(nearer, std::min(farther, nearer + 1.0F) - 20.0F * kHit);
    const float least = least_between(tape, truth[i].direction, nearer - kHit, end);
    const bool grazes = least > -1e-5F * (1.0F + nearer) && least < 2.0F * kHit;
    (grazes ? result.grazing : result.wrong) += 1;
  }
  return result;
}

TraceOptions exact(Method method) {
  TraceOptions options;
  options.method = method;
  options.hit_pixels = 0.0F;
  options.hit_m = kHit;
  options.max_steps = 4000;
  return options;
}

class FirstHits : public testing::TestWithParam<HardScene> {};

TEST_P(FirstHits, OfConesAreThoseOfFullSphereTracing) {
  const HardScene& scene = GetParam();
  const Pose pose = math::look_at(scene.eye, scene.target, {0.0, 1.0, 0.0});
  const Program program = compile(scene.field, 0.0, scene.eye);
  const PixelGrid grid = ordinary_grid(180, 140);
  const Traced full = trace_picture(program, pose, grid, exact(Method::Full));
  for (const Method method : {Method::FullBest, Method::Cones}) {
    const Traced found = trace_picture(program, pose, grid, exact(method));
    const Comparison comparison = compare(program, full.hits, found.hits);
    EXPECT_EQ(comparison.wrong, 0);
    EXPECT_LT(comparison.grazing, static_cast<int>(full.hits.size() / 200));
    EXPECT_LT(found.counts.evaluations(), full.counts.evaluations());
  }
}

INSTANTIATE_TEST_SUITE_P(Sdf, FirstHits, testing::ValuesIn(hard_scenes()),
                         [](const auto& scene) { return std::string(scene.param.name); });

// ---- the bits of a hit ----

/// Shares of the rays that hit in both traces whose hits differ in place, normal or material, or in
/// place, and of all rays those that hit in one only.
struct Unequal {
  double bits = 0.0, place = 0.0, status = 0.0;
};
Unequal unequal_hits(const std::vector<Hit>& a, const std::vector<Hit>& b) {
  int both = 0, bits = 0, place = 0, status = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    status += a[i].status != b[i].status;
    if (a[i].status != RayStatus::Hit || b[i].status != RayStatus::Hit) continue;
    ++both;
    place += a[i].t != b[i].t;
    bits += a[i].t != b[i].t || a[i].normal != b[i].normal || a[i].material != b[i].material;
  }
  return {static_cast<double>(bits) / std::max(both, 1),
          static_cast<double>(place) / std::max(both, 1),
          static_cast<double>(status) / static_cast<double>(a.size())};
}

/// Foveated pictures were FLIP .0014 from plain ones in the fovea: methods stop at different places
/// within the hit distance. They must agree on the bits of where a ray crosses.
TEST_P(FirstHits, HaveTheBitsOfFullSphereTracing) {
  const HardScene& scene = GetParam();
  const Pose pose = math::look_at(scene.eye, scene.target, {0.0, 1.0, 0.0});
  const Program program = compile(scene.field, 0.0, scene.eye);
  const PixelGrid grid = ordinary_grid(160, 120, Degrees{8.0});  // a headset's pixels
  // Towards its horizon a floor falls off by less than roundings over a cell.
  const bool grazing = std::string_view(scene.name) == "poles";
  TraceOptions options;
  options.method = Method::Full;
  options.max_steps = 4000;
  const Traced full = trace_picture(program, pose, grid, options);
  for (const Method method : {Method::FullBest, Method::Cones}) {
    options.method = method;
    const Unequal unequal =
        unequal_hits(full.hits, trace_picture(program, pose, grid, options).hits);
    EXPECT_LE(unequal.bits, grazing ? 3e-2 : 1e-3) << scene.name;
    EXPECT_LE(unequal.status, 1e-2) << scene.name;
  }
  // The place does not depend on how near is near enough, either.
  options.method = Method::Cones;
  options.hit_pixels = 0.02F;
  const Unequal closer = unequal_hits(full.hits, trace_picture(program, pose, grid, options).hits);
  EXPECT_LE(closer.place, grazing ? 6e-2 : 2e-2) << scene.name;
}

TEST_P(FirstHits, FromBesideHaveOtherBits) {
  const HardScene& scene = GetParam();
  const Pose pose = math::look_at(scene.eye, scene.target, {0.0, 1.0, 0.0});
  const PixelGrid grid = ordinary_grid(40, 30, Degrees{8.0});
  const Traced here = trace_picture(compile(scene.field, 0.0, scene.eye), pose, grid, {});
  const DVec3 beside = scene.eye + DVec3{1e-4, 0.0, 0.0};
  const Traced there = trace_picture(compile(scene.field, 0.0, beside), pose, grid, {});
  EXPECT_GT(unequal_hits(here.hits, there.hits).bits, 0.1) << scene.name;
}

// ---- the bound each field states ----

struct Pairs {
  int checked = 0, violated = 0;
};

/// |f(a) - f(b)| <= |a - b| for points within `reach` of the origin, near and far from each other.
Pairs check_bound(const Program& program, int pairs, double reach) {
  const Tape tape = make_tape(program);
  Registers registers;
  PointBatch points{};
  DistanceBatch found{};
  Pairs result;
  std::uint64_t state = 1;
  const auto uniform = [&state] { return 2.0F * math::unit_float(math::hash_mix(state++)) - 1.0F; };
  while (result.checked < pairs) {
    for (std::size_t i = 0; i < kBatch; i += 2) {
      const Vec3 a = static_cast<float>(reach) * Vec3(uniform(), uniform(), uniform());
      const float apart = std::pow(10.0F, -1.5F + 1.5F * uniform());
      points.set(i, a);
      points.set(i + 1, a + apart * Vec3(uniform(), uniform(), uniform()));
    }
    evaluate(tape, points, kBatch, registers, found);
    for (std::size_t i = 0; i < kBatch; i += 2, ++result.checked) {
      const Vec3 step{points.x[i] - points.x[i + 1], points.y[i] - points.y[i + 1],
                      points.z[i] - points.z[i + 1]};
      const float change = std::abs(found.at[i] - found.at[i + 1]);
      const float rounding = 2e-5F * (1.0F + std::abs(found.at[i]));
      result.violated += change <= glm::length(step) * (1.0F + 1e-4F) + rounding ? 0 : 1;
    }
  }
  return result;
}

TEST_P(FirstHits, StandOnABoundThatHolds) {
  const Program program = compile(GetParam().field, 0.0, DVec3{0.0, 1.0, 0.0});
  EXPECT_EQ(check_bound(program, 200000, 8.0).violated, 0);
  EXPECT_EQ(check_bound(program, 200000, 1.5).violated, 0);
}

TEST(LipschitzBound, ThatAFileStatesTooSmallIsCaught) {
  const std::string twist = R"({"type": "twist", "deg_per_m": 120, "within_radius": 1, %
      "of": {"type": "box", "half_size": [0.6, 1, 0.2]}})";
  std::string honest = twist, wrong = twist;
  honest.replace(honest.find('%'), 1, "");
  wrong.replace(wrong.find('%'), 1, R"("lipschitz": 1.0,)");
  EXPECT_EQ(check_bound(compile(scene_of(honest), 0.0, DVec3{0.0}), 100000, 1.2).violated, 0);
  EXPECT_GT(check_bound(compile(scene_of(wrong), 0.0, DVec3{0.0}), 100000, 1.2).violated, 100);
}

TEST(LipschitzBound, ThatAFileStatesLargerMakesStepsShorter) {
  const Field plain = scene_of(R"({"type": "sphere", "radius": 1})");
  const Field stated = scene_of(R"({"type": "sphere", "radius": 1, "lipschitz": 2})");
  const Program a = compile(plain, 0.0, DVec3{0.0}), b = compile(stated, 0.0, DVec3{0.0});
  EXPECT_FLOAT_EQ(evaluate_at(make_tape(a), {3.0F, 0.0F, 0.0F}), 2.0F);
  EXPECT_FLOAT_EQ(evaluate_at(make_tape(b), {3.0F, 0.0F, 0.0F}), 1.0F);
}

// ---- the interval a cone may take for free ----

// ALGORITHMS 5.3: all points s v with t <= s < t cos th + sqrt(d^2 - t^2 sin^2 th), angle(v, axis)
// <= th, are less than d away from t axis.
TEST(ConeStep, StaysInsideTheBallThatIsFree) {
  std::uint64_t state = 7;
  const auto uniform = [&state] { return math::unit_float(math::hash_mix(state++)); };
  int steps = 0;
  for (int i = 0; i < 100000; ++i) {
    const double th = std::pow(10.0, -4.0 + 4.0 * uniform()), t = 0.1 + 10.0 * uniform();
    const double h = std::sin(0.5 * th), d = 2.0 * t * h * (1.001 + 3.0 * uniform());
    const double step = std::sqrt(d * d - t * t * std::sin(th) * std::sin(th)) - 2.0 * t * h * h;
    if (!(step > 0.0)) continue;
    ++steps;
    const double angle = th * uniform(), s = t + step * uniform() * 0.999999;
    const double apart = std::sqrt(s * s + t * t - 2.0 * s * t * std::cos(angle));
    ASSERT_LT(apart, d * (1.0 + 1e-9));
    ASSERT_GE(step, (d - 2.0 * t * h) * (1.0 - 1e-9));  // never less than the triangle's step
  }
  EXPECT_GT(steps, 90000);
}

}  // namespace
}  // namespace macula::sdf
