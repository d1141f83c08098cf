// What a plan leaves out would cost: every step that is left out is forced on by itself, and then
// the scene's structures are larger, or a frame traces more rays, or takes more processor time.
#include <malloc.h>

#include <algorithm>
#include <iomanip>
#include <iostream>
#include <set>
#include <vector>

#include "server/kernels/scene_timeline.h"
#include "shared/base/cpu_time.h"
#include "tests/conformance/plan_scenes.h"

namespace macula {
namespace {

using kernels::SceneFrame;
using scene::ScenePlan;
using scene::Step;
using scene::StepUse;
using ScenePointer = std::shared_ptr<const scene::Scene>;

/// In use, large blocks included.
std::size_t heap_bytes() {
  const auto heap = ::mallinfo2();
  return heap.uordblks + heap.hblkhd;
}

/// A scene built to a plan, and what that and its frames cost.
class Built {
 public:
  Built(const ScenePointer& scene, const ScenePlan& plan) {
    const std::size_t before = heap_bytes();
    const auto begin = base::thread_cpu_time();
    timeline_ = *kernels::SceneTimeline::create(scene, plan);
    frame_at(0);
    build_ms_ = units::to_ms(base::thread_cpu_time() - begin);
    bytes_ = static_cast<double>(heap_bytes()) - static_cast<double>(before);
  }
  /// Processor time of a frame at another moment than the one before.
  double render_ms(kernels::TileScheduler& scheduler) {
    kernels::KernelOptions options;
    options.mode = kernels::Mode::Exact;
    options.area_light_samples = 2, options.ambient_samples = 16;
    const kernels::View view = test::view_on(foveation::make_uniform_grid(test::display(64)));
    const auto begin = base::thread_cpu_time();
    test::render("ray", options, *frame_at(++moment_), view, scheduler);
    return units::to_ms(base::thread_cpu_time() - begin);
  }
  double bytes() const { return bytes_; }
  double build_ms() const { return build_ms_; }

 private:
  std::shared_ptr<const SceneFrame> frame_at(int moment) {
    return *timeline_->at({std::chrono::milliseconds{10 * moment}});
  }
  std::shared_ptr<kernels::SceneTimeline> timeline_;
  int moment_ = 0;
  double bytes_ = 0.0, build_ms_ = 0.0;
};

/// Of an even number of values.
double median(std::vector<double> values) {
  std::ranges::sort(values);
  return 0.5 * (values[values.size() / 2 - 1] + values[values.size() / 2]);
}

/// What one plan costs beside another: medians of pairs built and rendered in turns, so that what
/// else the machine does meets both.
struct Surplus {
  double bytes = 0.0;        ///< more than the other's
  double build_ratio = 1.0;  ///< of the processor time to build it
  double frame_ratio = 1.0;  ///< and of a frame

  bool is_a_cost() const { return bytes > 72.0 || build_ratio > 1.05 || frame_ratio > 1.05; }
};
Surplus surplus(const ScenePointer& scene, const ScenePlan& plan, const ScenePlan& other) {
  constexpr int kTurns = 26;
  kernels::TileScheduler scheduler(1);
  std::vector<double> bytes, builds, frames;
  for (int turn = 0; turn < kTurns; ++turn) {
    // Each by itself: of two scenes that live at once the second finds more rooms taken.
    const double bytes_of_it = Built(scene, plan).bytes();
    bytes.push_back(bytes_of_it - Built(scene, other).bytes());
    // Whoever is second finds caches warm.
    const bool goes_first = turn % 2 == 0;
    Built first(scene, goes_first ? plan : other), second(scene, goes_first ? other : plan);
    const double build = first.build_ms() / second.build_ms();
    const double first_ms = first.render_ms(scheduler);
    const double frame = first_ms / second.render_ms(scheduler);
    builds.push_back(goes_first ? build : 1.0 / build);
    frames.push_back(goes_first ? frame : 1.0 / frame);
  }
  return {median(bytes), median(builds), median(frames)};
}

/// Lit by many lamps, so that light is most of a frame.
scene::Scene many_lamps() {
  scene::Scene scene = test::bare();
  for (int i = 0; i < 15; ++i) {
    scene.lights.push_back(scene.lights.front());
    scene.lights.back().position.x = -2.0 + 0.25 * i;
  }
  return scene;
}

/// A scene of triangles has no field that a tracer could be made of, one without lamps has an empty
/// list of them, and kernel ray makes no virtual lights.
bool has_nothing_to_build(Step step) {
  return step == Step::DistanceField || step == Step::VirtualLights || step == Step::PunctualLights;
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kInstrumented = true;  ///< memory and time are counted with the sanitizer's
#else
constexpr bool kInstrumented = false;
#endif

TEST(LeftOutStep, CostsMemoryOrTimeWhenForced) {
  if (kInstrumented) GTEST_SKIP() << "sanitizers cost memory and time of their own";
  std::set<Step> forced;
  for (const scene::Scene& made : {many_lamps(), test::nothing_to_see()}) {
    const auto scene = std::make_shared<const scene::Scene>(made);
    const ScenePlan plan(scene::facts_of(*scene), {.kernel = "ray"});
    for (const scene::PlannedStep& step : plan.steps()) {
      if (step.use != StepUse::LeftOut || has_nothing_to_build(step.step)) continue;
      if (!forced.insert(step.step).second) continue;
      Surplus cost;
      for (int tries = 0; tries < 3 && !cost.is_a_cost(); ++tries)
        cost = surplus(scene, plan.forcing(step.step), plan.without(step.step));
      std::cout << std::setw(34) << step.name << std::fixed << std::setprecision(0) << std::setw(8)
                << cost.bytes << " bytes more, built in x " << std::setprecision(2)
                << cost.build_ratio << ", a frame in x " << cost.frame_ratio << '\n';
      EXPECT_TRUE(cost.is_a_cost()) << step.name;
    }
  }
  EXPECT_EQ(forced.size(), 11U) << "every step but those three";
}

TEST(LeftOutStep, CostsNothing) {
  // Must-fail twin: were a difference found where there is none, the costs above would mean
  // nothing.
  if (kInstrumented) GTEST_SKIP() << "sanitizers cost memory and time of their own";
  const auto scene = std::make_shared<const scene::Scene>(many_lamps());
  const ScenePlan plan(scene::facts_of(*scene), {.kernel = "ray"});
  bool found = true;
  for (int tries = 0; tries < 3 && found; ++tries) found = surplus(scene, plan, plan).is_a_cost();
  EXPECT_FALSE(found);
}

}  // namespace
}  // namespace macula
