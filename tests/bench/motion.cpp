#include "tests/bench/motion.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>

#include "server/kernels/scene_timeline.h"
#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/shapes.h"
#include "tests/bench/progress.h"
#include "tests/bench/report.h"

namespace macula::bench {
namespace {

using namespace scene::built_in;
using scene::Index;
using scene::SceneTime;

constexpr double kTurn = 2.0 * std::numbers::pi;

// ---- scenes that move in one way each ----

/// Wanders round its place: eight keys of position and rotation over two seconds.
scene::Joint wandering(const DVec3& place, double phase) {
  scene::Joint joint;
  joint.parent_from_base = translation(place);
  joint.period = std::chrono::seconds{2};
  for (int key = 0; key <= 8; ++key) {
    const double angle = kTurn * (key / 8.0 + phase);
    joint.translations.times_s.push_back(0.25 * key);
    joint.translations.values.push_back(
        {0.3 * std::cos(angle), 0.2 * std::sin(2.0 * angle), 0.3 * std::sin(angle)});
    joint.rotations.times_s.push_back(0.25 * key);
    joint.rotations.values.push_back(glm::angleAxis(angle, DVec3{0, 1, 0}));
  }
  return joint;
}

/// Places on a square lattice of 1 m, `count` of them.
DVec3 lattice(int i, int count) {
  const int side = static_cast<int>(std::ceil(std::sqrt(count)));
  return {i % side - 0.5 * side, 1.0, i / side - 0.5 * side};
}

/// A still ground of some 200k triangles.
void add_ground(SceneBuilder& builder, Index material) {
  const auto hills = [](float u, float v) {
    return Vec3{200.0F * (u - 0.5F), 0.3F * std::sin(40.0F * u) * std::cos(35.0F * v),
                200.0F * (0.5F - v)};
  };
  builder.place(tessellate("ground", hills, {.columns = 320, .rows = 320}), material);
}

scene::Scene crowd(int count) {
  SceneBuilder builder("crowd");
  const Index material = builder.add(lambert("clay", Rgb{0.6F}));
  add_ground(builder, material);
  const Index ball = builder.add(sphere("ball", 0.3F, 32, 16), material);
  for (int i = 0; i < count; ++i) {
    const Index joint = builder.add(wandering(lattice(i, count), 0.37 * i));
    builder.hang(joint, ball);
  }
  return std::move(builder).finish();
}

/// 2 side^2 triangles that wave.
scene::Scene sheet(int side) {
  const auto at = [side](int key) {
    const auto phase = static_cast<float>(kTurn * key / 8.0);
    const auto wave = [phase](float u, float v) {
      return Vec3{10.0F * u, 10.0F * v, 0.4F * std::sin(9.0F * u + 5.0F * v - phase)};
    };
    return tessellate("sheet", wave, {.columns = side, .rows = side});
  };
  SceneBuilder builder("sheet");
  scene::Mesh mesh = at(0);
  for (int key = 0; key <= 8; ++key) {
    scene::Mesh shape = at(key % 8);
    mesh.deformation.times_s.push_back(0.25 * key);
    mesh.deformation.positions.push_back(std::move(shape.positions));
    mesh.deformation.normals.push_back(std::move(shape.normals));
  }
  mesh.deformation.period = std::chrono::seconds{2};
  builder.place(std::move(mesh), builder.add(lambert("cloth", Rgb{0.6F})));
  return std::move(builder).finish();
}

/// Point lights, some sixty to a joint, over the ground.
scene::Scene fireflies(int count) {
  SceneBuilder builder("fireflies");
  add_ground(builder, builder.add(lambert("grass", Rgb{0.3F})));
  const int joints = std::max(1, count / 61);
  for (int i = 0; i < joints; ++i) builder.add(wandering(lattice(i, joints), 0.61 * i));
  for (int i = 0; i < count; ++i) {
    scene::Light light;
    light.position = {0.4 * std::cos(2.4 * i), 0.1 * std::sin(1.7 * i), 0.4 * std::sin(2.4 * i)};
    light.joint = static_cast<Index>(i % joints);
    builder.add(light);
  }
  return std::move(builder).finish();
}

/// Emissive triangles by the hundred, each hundred carried by a joint.
scene::Scene lanterns(int triangles) {
  SceneBuilder builder("lanterns");
  add_ground(builder, builder.add(lambert("grass", Rgb{0.3F})));
  scene::Mesh ball = sphere("lantern", 0.1F, 10, 6);
  const int count = triangles / static_cast<int>(ball.triangles.size());
  const Index mesh = builder.add(std::move(ball), builder.add(lamp("lantern", Rgb{5.0F})));
  for (int i = 0; i < count; ++i) {
    const Index joint = builder.add(wandering(lattice(i, count), 0.37 * i));
    builder.hang(joint, mesh);
  }
  return std::move(builder).finish();
}

// ---- measuring ----

double cpu_ms() {
  return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Mean CPU time of step(k), k = 0, 1, ..., over enough calls for the process clock.
double mean_ms(const MotionOptions& options, const std::function<void(int)>& step) {
  const double enough_ms = options.quick ? 20.0 : 400.0;
  step(0);  // memory and caches
  const double begin = cpu_ms();
  int calls = 0;
  double spent = 0.0;
  do {
    step(++calls);
    spent = cpu_ms() - begin;
  } while (spent < enough_ms && calls < 1000);
  return spent / calls;
}

/// Moments 17 ms apart, as a server at 60 Hz asks for them.
SceneTime moment(int k) {
  return {std::chrono::milliseconds{17} * k};
}

/// One row; what a scene has none of is measured all the same, near 0.
Result<Fields> measure(const char* what, int count, const scene::Scene& made,
                       const MotionOptions& options) {
  const auto scene = std::make_shared<const scene::Scene>(made);
  const scene::MovingParts moving = scene::moving_parts(*scene);
  scene::ScenePose pose = scene::pose_at(*scene, {});
  const shading::MaterialTable materials(*scene);
  shading::SurfaceTable surfaces(*scene, pose);
  lights::LightList lights(*scene, pose, materials);
  const auto source = visibility::MovingTriangles::create(*scene, moving, pose);
  if (!source) return base::forward(source);
  const auto triangles = (*source)->make(pose);
  if (!triangles) return base::forward(triangles);
  const auto timeline = kernels::SceneTimeline::create(scene);
  if (!timeline) return base::forward(timeline);

  bool good = true;
  const auto posed = [&](int k) { scene::repose(*scene, moving, moment(k), pose); };
  const double pose_ms = mean_ms(options, posed);
  const double pose_and_triangles_ms = mean_ms(options, [&](int k) {
    posed(k);
    good = good && (*source)->move(**triangles, pose);
  });
  const double surfaces_ms =
      mean_ms(options, [&](int) { surfaces.move(*scene, moving.instances, pose); });
  const double lights_ms =
      mean_ms(options, [&](int) { lights.move(*scene, moving, pose, materials); });
  const double moment_ms =
      mean_ms(options, [&](int k) { good = good && (*timeline)->at(moment(k)); });
  const double rebuild_ms = mean_ms(
      options, [&](int) { good = good && visibility::TriangleScene::create(*scene, pose); });
  if (!good) return base::runtime_error("a structure cannot be built", scene->name);
  return Fields{{"case", std::string(what)},
                {"count", std::int64_t{count}},
                {"triangles", static_cast<std::int64_t>(scene->triangle_count())},
                {"pose_cpu_ms", pose_ms},
                {"triangles_cpu_ms", pose_and_triangles_ms - pose_ms},
                {"surfaces_cpu_ms", surfaces_ms},
                {"lights_cpu_ms", lights_ms},
                {"moment_cpu_ms", moment_ms},
                {"rebuild_cpu_ms", rebuild_ms}};
}

}  // namespace

Result<void> run_motion(const MotionOptions& options) {
  struct Case {
    const char* what;
    int count, quick_count;
    scene::Scene (*make)(int);
  };
  const Case cases[] = {
      {"instances", 64, 4, crowd},
      {"instances", 1024, 64, crowd},
      {"instances", 16384, 256, crowd},
      {"deforming_side", 384, 96, sheet},
      {"point_lights", 250'000, 5'000, fireflies},
      {"emissive_triangles", 250'000, 5'000, lanterns},
  };
  Report report{"motion", {{"quick", options.quick}}, {}};
  Progress progress("measuring", std::size(cases));
  for (const Case& one : cases) {
    const int count = options.quick ? one.quick_count : one.count;
    auto row = measure(one.what, count, one.make(count), options);
    if (!row) return base::forward(row);
    report.rows.push_back(std::move(*row));
    progress.advance();
  }
  std::fputs(table_text(report.rows).c_str(), stdout);
  return options.json.empty() ? Result<void>{} : write_json(options.json, report);
}

}  // namespace macula::bench
