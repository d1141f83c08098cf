#include "tests/bench/light_tree.h"

#include <bit>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <vector>

#include <hwy/highway.h>

#include "server/lights/placed_lights.h"
#include "server/scene/animation.h"
#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/shapes.h"
#include "shared/math/hash.h"
#include "tests/bench/progress.h"
#include "tests/bench/report.h"
#include "tests/bench/scalar_walk.h"
#include "tests/bench/stopwatch.h"

namespace macula::bench {
namespace {

using scene::Index;

class Random {
 public:
  explicit Random(std::uint64_t seed) : seed_(seed) {}
  double next() { return static_cast<double>(math::hash_combine(seed_, count_++) >> 11) * 0x1p-53; }
  double within(double half) { return half * (2.0 * next() - 1.0); }

 private:
  std::uint64_t seed_, count_ = 0;
};

// ---- lights that move ----

scene::Joint swinging(const DVec3& place, double phase) {
  scene::Joint joint;
  joint.parent_from_base = scene::built_in::translation(place);
  joint.period = std::chrono::seconds{2};
  for (int key = 0; key <= 8; ++key) {
    const double angle = 2.0 * std::numbers::pi * (key / 8.0 + phase);
    joint.translations.times_s.push_back(0.25 * key);
    joint.translations.values.push_back({0.3 * std::cos(angle), 0.0, 0.3 * std::sin(angle)});
  }
  return joint;
}

/// Strings of sixty over a garden of 40 m x 4 m x 40 m.
scene::Scene garden(int count, const std::function<void(scene::Scene&, Index joint, int)>& hang) {
  scene::Scene scene;
  constexpr int kOnAString = 60;
  Random random(1);
  for (int first = 0; first < count; first += kOnAString) {
    const DVec3 place{random.within(20.0), 2.0 + random.within(2.0), random.within(20.0)};
    scene.joints.push_back(swinging(place, random.next()));
    hang(scene, static_cast<Index>(scene.joints.size() - 1), std::min(kOnAString, count - first));
  }
  return scene;
}

scene::Scene points(int count) {
  Random random(2);
  return garden(count, [&](scene::Scene& scene, Index joint, int lights) {
    for (int i = 0; i < lights; ++i) {
      scene::Light light;
      light.position = {random.within(1.0), random.within(0.2), random.within(1.0)};
      light.intensity = Rgb{static_cast<float>(0.5 + random.next())};
      light.joint = joint;
      scene.lights.push_back(light);
    }
  });
}

scene::Scene triangles(int count) {
  Random random(3);
  scene::Material glow;
  glow.emission = Rgb{5.0F};
  scene::Scene made = garden(count, [&](scene::Scene& scene, Index joint, int lights) {
    scene::Mesh mesh;
    for (int i = 0; i < lights; ++i) {
      const Vec3 at(DVec3{random.within(1.0), random.within(0.2), random.within(1.0)});
      const auto first = static_cast<Index>(mesh.positions.size());
      for (int corner = 0; corner < 3; ++corner) {
        mesh.positions.push_back(
            at + Vec3(DVec3{random.within(0.02), random.within(0.02), random.within(0.02)}));
      }
      mesh.triangles.push_back({first, first + 1, first + 2});
    }
    scene.meshes.push_back(std::move(mesh));
    scene.instances.push_back({static_cast<Index>(scene.meshes.size() - 1), DMat4{1.0}, joint});
  });
  made.materials.push_back(glow);
  return made;
}

// ---- measuring ----

/// Mean CPU milliseconds of `times` calls after a first one.
double mean_ms(int times, const std::function<void(int)>& step) {
  step(0);
  Stopwatch watch;
  for (int k = 1; k <= times; ++k) step(k);
  return watch.lap().cpu_ms / times;
}

std::vector<lights::Receiver> receivers_in_garden() {
  Random random(4);
  std::vector<lights::Receiver> receivers;
  for (int i = 0; i < 4096; ++i) {
    const Vec3 place(DVec3{random.within(20.0), random.next(), random.within(20.0)});
    const DVec3 normal{random.within(1.0), 0.5 + random.next(), random.within(1.0)};
    receivers.push_back({place, Vec3(glm::normalize(normal))});
  }
  return receivers;
}

/// Of one descent from the root, nanoseconds.
struct DescentTimes {
  double together = 1e30;  ///< LightWalk's, as kernels make them: many at once
  double alone = 1e30;     ///< LightWalk's, one after another
  double scalar = 1e30;
};
/// All by turns, so that what else the machine does falls on all alike.
DescentTimes time_descents(const lights::LightTree& tree, int rounds) {
  const ScalarTree scalar(tree);
  const auto receivers = receivers_in_garden();
  Random random(5);
  std::vector<lights::Descent> descents;
  for (const lights::Receiver& receiver : receivers) {
    descents.push_back({receiver, 1, static_cast<double>(static_cast<float>(random.next()))});
  }
  std::vector<lights::LeafChoice> choices(descents.size());
  DescentTimes best;
  std::uint64_t used = 0;
  Stopwatch watch;
  const auto lap_ns = [&] {
    return 1e6 * watch.lap().cpu_ms / static_cast<double>(descents.size());
  };
  constexpr auto kRule = lights::WeightRule::NearAndFar;
  for (int round = 0; round < rounds; ++round) {
    watch.lap();
    lights::choose_each(tree, kRule, descents, choices);
    best.together = std::min(best.together, lap_ns());
    for (const lights::Descent& descent : descents) {
      used += lights::LightWalk(tree, descent.receiver, kRule).choose(1, descent.u).leaf;
    }
    best.alone = std::min(best.alone, lap_ns());
    for (const lights::Descent& descent : descents) {
      used += scalar.choose(descent.receiver, static_cast<float>(descent.u)).leaf;
    }
    best.scalar = std::min(best.scalar, lap_ns());
  }
  for (const lights::LeafChoice& choice : choices) used += choice.leaf;
  if (used == 0) std::fputs("no light reached any receiver\n", stderr);
  return best;
}

struct Isa {
  const char* name;
  std::int64_t targets;
};
/// What this processor has, the best first.
std::vector<Isa> isas() {
  const std::int64_t here = hwy::SupportedTargets();
  std::vector<Isa> all;
  for (const Isa& isa : {Isa{"avx512", HWY_AVX3_DL | HWY_AVX3}, Isa{"avx2", HWY_AVX2},
                         Isa{"sse4", HWY_SSE4 | HWY_SSSE3}}) {
    const std::int64_t able = here & isa.targets;
    if (able != 0) all.push_back({isa.name, able});
  }
  return all;
}

Fields measure(const char* kind, const scene::Scene& scene, const Isa& isa, bool quick) {
  hwy::SetSupportedTargetsForTest(isa.targets);
  const scene::MovingParts moving = scene::moving_parts(scene);
  scene::ScenePose pose = scene::pose_at(scene, {});
  const shading::MaterialTable materials(scene);
  lights::LightList list(scene, pose, materials);
  lights::PlacedLights placed(list);
  const int times = quick ? 10 : 100;
  const double motion_ms = mean_ms(times, [&](int k) {
    scene::repose(scene, moving, {std::chrono::milliseconds{17} * k}, pose);
    list.move(scene, moving, pose, materials);
  });
  const double placed_ms = mean_ms(times, [&](int) { placed.make(list); });
  const DescentTimes descents = time_descents(placed.tree(), times);
  hwy::SetSupportedTargetsForTest(0);
  return {{"lights", std::string(kind)},
          {"count", static_cast<std::int64_t>(placed.size())},
          {"isa", std::string(isa.name)},
          {"motion_cpu_ms", motion_ms},
          {"tree_cpu_ms", placed_ms},
          {"rebuild_cpu_ms", motion_ms + placed_ms},
          {"descent_ns", descents.together},
          {"lone_descent_ns", descents.alone},
          {"scalar_descent_ns", descents.scalar},
          {"descent_ratio", descents.scalar / descents.together}};
}

}  // namespace

Result<void> run_light_tree(const LightTreeOptions& options) {
  Report report{"light-tree", {{"quick", options.quick}}, {}};
  const std::vector<Isa> tried = isas();
  constexpr int kCounts[] = {64'000, 250'000};
  Progress progress("measuring", 4 * tried.size());
  for (const int count : kCounts) {
    const scene::Scene scenes[] = {points(count), triangles(count)};
    for (const Isa& isa : tried) {
      for (const scene::Scene& scene : scenes) {
        const char* kind = scene.lights.empty() ? "triangles" : "points";
        report.rows.push_back(measure(kind, scene, isa, options.quick));
        progress.advance();
      }
    }
  }
  std::fputs(table_text(report.rows).c_str(), stdout);
  return options.json.empty() ? Result<void>{} : write_json(options.json, report);
}

}  // namespace macula::bench
