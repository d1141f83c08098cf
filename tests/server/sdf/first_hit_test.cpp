// The claim of the room: cones, pruning and relaxed steps find the same first hits as plain sphere
// tracing with the whole program, to the bit, on scenes made to break that. MACULA_SDF_RAYS=1000000
// sends a million rays a scene.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "server/sdf/crossing.h"
#include "server/sdf/evaluate.h"
#include "server/sdf/march.h"
#include "server/sdf/tape.h"
#include "shared/math/hash.h"
#include "tests/server/sdf/tracing.h"

namespace macula::sdf {
namespace {

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

class FirstHits : public testing::TestWithParam<HardScene> {
 protected:
  Program program() const { return compile(GetParam().field, 0.0, GetParam().eye); }
  Pose pose() const { return math::look_at(GetParam().eye, GetParam().target, {0.0, 1.0, 0.0}); }

  /// Cones, and relaxed and pruned rays alone, against plain ones. Rays that plain steps do not
  /// bring to an end are told apart.
  void expect_those_of_full(const PixelGrid& grid, TraceOptions options) {
    const Program field = program();
    options.method = Method::Full, options.max_steps = 65535;
    const Traced full = trace_picture(field, pose(), grid, options);
    EXPECT_EQ(full.counts.capped, 0U);
    for (const Method method : {Method::FullBest, Method::Cones}) {
      options.method = method;
      const Traced found = trace_picture(field, pose(), grid, options);
      EXPECT_EQ(differences(full.hits, found.hits), 0U);
    }
  }
};

/// A fixed hit distance, whatever the pixels.
TEST_P(FirstHits, AreThoseOfFullSphereTracingToTheBit) {
  TraceOptions options;
  options.hit_pixels = 0.0F, options.hit_m = 1e-4F;
  expect_those_of_full(grid_of(many(25000)), options);
}

/// A headset's pixels: foveated pictures were FLIP .0014, then .0001 from plain ones in the fovea,
/// because methods stopped at different places within the hit distance.
TEST_P(FirstHits, OfAHeadsetsPixelsAreThoseOfFullSphereTracingToTheBit) {
  expect_those_of_full(grid_of(many(20000), Degrees{8.0}), {});
}

/// How near is near enough may move the last digits of a place, and what only touches by no more
/// than the way on which a crossing is looked for. Rays over the poles' floor towards its horizon
/// may go on to something else.
TEST_P(FirstHits, HardlyDependOnTheHitDistance) {
  const PixelGrid grid = grid_of(5000, Degrees{8.0});
  TraceOptions options;
  const Traced usual = trace_picture(program(), pose(), grid, options);
  options.hit_pixels *= 0.25F;
  const Traced closer = trace_picture(program(), pose(), grid, options);
  std::size_t same = 0;
  for (std::size_t i = 0; i < usual.hits.size(); ++i) {
    const Hit &a = usual.hits[i], &b = closer.hits[i];
    same += a.status == b.status && (a.t == b.t || std::abs(a.t - b.t) < kCrossingReach * a.t);
  }
  EXPECT_GT(same, usual.hits.size() * 3 / 4);
}

INSTANTIATE_TEST_SUITE_P(Sdf, FirstHits, testing::ValuesIn(hard_scenes()),
                         [](const auto& scene) { return std::string(scene.param.name); });

TEST_P(FirstHits, FromBesideHaveOtherBits) {
  const HardScene& scene = GetParam();
  const Pose pose = math::look_at(scene.eye, scene.target, {0.0, 1.0, 0.0});
  const PixelGrid grid = ordinary_grid(40, 30, Degrees{8.0});
  const Traced here = trace_picture(compile(scene.field, 0.0, scene.eye), pose, grid, {});
  const DVec3 beside = scene.eye + DVec3{1e-4, 0.0, 0.0};
  const Traced there = trace_picture(compile(scene.field, 0.0, beside), pose, grid, {});
  EXPECT_GT(differences(here.hits, there.hits), here.hits.size() / 20) << scene.name;
}

/// A twisted plate whose steps are three times too long: what is passed depends on where a ray
/// stops.
TEST(WrongBound, GivesOtherFirstHitsThanFullSphereTracing) {
  const Field field = scene_of(R"({"type": "twist", "deg_per_m": 120, "within_radius": 1,
      "lipschitz": 1.0, "of": {"type": "box", "half_size": [0.8, 1, 0.05]}})");
  const Pose pose = math::look_at({0.4, 0.8, 3.0}, DVec3{0.0}, {0.0, 1.0, 0.0});
  const Program program = compile(field, 0.0, pose.position);
  TraceOptions options;
  options.method = Method::Full;
  const Traced full = trace_picture(program, pose, grid_of(20000), options);
  const Traced cones = trace_picture(program, pose, grid_of(20000), {});
  EXPECT_GT(differences(full.hits, cones.hits), 100U);
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
  EXPECT_EQ(check_bound(program, many(200000), 8.0).violated, 0);
  EXPECT_EQ(check_bound(program, many(200000), 1.5).violated, 0);
}

/// What a lane passes without looking is proven by distances found elsewhere, so their roundings
/// count: how much faster than its bound the field seems to change between places of a ray that lie
/// close together, relative to what kFieldRounding is of.
TEST_P(FirstHits, StandOnRoundingsThatAreAllowedFor) {
  const Program field = program();
  const Tape tape = make_tape(field);
  Registers registers;
  PointBatch points{};
  DistanceBatch found{};
  std::array<float, kBatch> t{};
  std::uint64_t state = 3;
  const auto uniform = [&state] { return math::unit_float(math::hash_mix(state++)); };
  float worst = 0.0F;
  for (int pair = 0; pair < many(200000);) {
    for (std::size_t i = 0; i < kBatch; i += 2) {
      const Vec3 to{2.0F * uniform() - 1.0F, 2.0F * uniform() - 1.0F, 2.0F * uniform() - 1.0F};
      const Vec3 direction = glm::normalize(to);
      t[i] = std::pow(10.0F, 3.0F * uniform() - 1.0F);
      t[i + 1] = t[i] * (1.0F + std::pow(10.0F, 5.0F * uniform() - 6.0F));
      points.set(i, t[i] * direction), points.set(i + 1, t[i + 1] * direction);
    }
    evaluate(tape, points, kBatch, registers, found);
    for (std::size_t i = 0; i < kBatch; i += 2, ++pair) {
      const float change = std::abs(found.at[i] - found.at[i + 1]) - (t[i + 1] - t[i]);
      worst = std::max(worst, change / (t[i] + std::abs(found.at[i])));
    }
  }
  EXPECT_LT(worst, 0.25F * kFieldRounding);  // positions round as well: march_simd.cpp's kRounding
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
  const int tries = many(100000);
  for (int i = 0; i < tries; ++i) {
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
  EXPECT_GT(steps, tries * 9 / 10);
}

}  // namespace
}  // namespace macula::sdf
