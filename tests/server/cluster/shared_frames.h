// What the tests of shared frames render: every kernel in both modes, two eyes of a head that
// turns, over frames that remember.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "server/cluster/ranked_kernel.h"
#include "server/kernels/registry.h"
#include "server/scene/load.h"

namespace macula::test {

using scheduling::TileScheduler;
using KernelList = std::vector<std::shared_ptr<const kernels::Kernel>>;

inline constexpr int kSide = 64;
inline constexpr std::uint64_t kFrames = 2;

struct Case {
  std::string kernel, scene;
  kernels::Mode mode = kernels::Mode::Fast;
  kernels::Reuse reuse = kernels::Reuse::Nothing;
  kernels::LightShare share = kernels::LightShare::Uniform;
  kernels::KnobValues knobs = {};
};
inline std::ostream& operator<<(std::ostream& out, const Case& of) {
  return out << of.kernel << (of.mode == kernels::Mode::Exact ? " exact" : " fast");
}

inline const std::vector<Case>& cases() {
  using kernels::Mode;
  static const std::vector<Case> all = {
      {"ray", "cornell", Mode::Exact},
      {"ray", "cornell", Mode::Fast},
      {"ray", "cornell", Mode::Fast, kernels::Reuse::EarlierFrames},
      {"lightcuts", "cornell", Mode::Exact},
      {"lightcuts", "cornell", Mode::Fast},
      {"lightcuts", "cornell", Mode::Fast, kernels::Reuse::Nothing, kernels::LightShare::Perceived},
      {"lightcuts",
       "moving",
       Mode::Fast,
       kernels::Reuse::Nothing,
       kernels::LightShare::Perceived,
       {{"gloss", "yes"}}},
      {"culling", "cornell", Mode::Exact},
      {"culling", "cornell", Mode::Fast},
      {"sphere", "primitives", Mode::Exact},
      {"sphere", "columns", Mode::Fast},
  };
  return all;
}

inline KernelList kernels_of(const Case& of) {
  kernels::KernelOptions options;
  options.mode = of.mode, options.reuse = of.reuse, options.light_share = of.share;
  auto made = kernels::make_kernel(of.kernel, options, of.knobs);
  EXPECT_TRUE(made) << (made ? "" : made.error().message());
  return {std::shared_ptr<const kernels::Kernel>(std::move(*made))};
}

inline std::shared_ptr<kernels::SceneTimeline> timeline_of(const std::string& name) {
  auto scene = scene::load_scene(name);
  EXPECT_TRUE(scene) << (scene ? "" : scene.error().message());
  auto timeline = kernels::SceneTimeline::create(*scene);
  EXPECT_TRUE(timeline) << (timeline ? "" : timeline.error().message());
  return *timeline;
}

/// Two eyes of a head that turns, the gaze off the middle.
inline std::vector<kernels::View> views_at(const scene::Scene& scene, std::uint64_t frame) {
  const foveation::Display display{math::symmetric_fov(Degrees{80.0}, 1.0), kSide, kSide};
  std::vector<kernels::View> views(2);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    kernels::View& view = views[eye];
    const DQuat turn = glm::angleAxis(0.03 * static_cast<double>(frame), DVec3{0, 1, 0});
    const Pose sway{{0.06 * static_cast<double>(eye), 1.6, 0.0}, turn};
    view.world_from_view = scene.settings.scene_from_stage * sway;
    view.gaze.direction = glm::normalize(Vec3{0.3F, -0.1F, -1.0F});
    view.grid = foveation::make_foveal_grid(display, view.gaze, foveation::RateModel{},
                                            {.full_rate_radius = Degrees{5.0}});
  }
  return views;
}

using Pictures = std::vector<kernels::FrameBuffers>;

inline Pictures render(const kernels::Kernel& kernel, kernels::SceneTimeline& timeline,
                       TileScheduler& scheduler) {
  kernels::History history;
  Pictures pictures;
  for (std::uint64_t frame = 0; frame < kFrames; ++frame) {
    const auto views = views_at(timeline.scene(), frame);
    const DVec2 pixel{2.0 * std::tan(0.5 * Radians{Degrees{80.0}}.value()) / kSide};
    std::vector<FoveationMap::ViewInput> inputs;
    for (const kernels::View& view : views) inputs.push_back({view.grid, view.gaze, pixel});
    const FoveationMap map(inputs, foveation::RateModel{});
    const auto scene = timeline.at(kernels::SceneTime{std::chrono::milliseconds{20 * frame}});
    EXPECT_TRUE(scene);
    kernels::FrameBuffers out;
    out.wanted = kernels::kSurfaceId | kernels::kRate;
    const auto report = kernel.render({views, map, frame, 1}, **scene, history, scheduler, out);
    EXPECT_FALSE(report.stopped);
    pictures.push_back(std::move(out));
  }
  return pictures;
}

inline Pictures render_alone(const Case& of) {
  const auto timeline = timeline_of(of.scene);
  TileScheduler scheduler(1);
  return render(*kernels_of(of)[0], *timeline, scheduler);
}

template <class T>
bool same_bits(const image::Plane<T>& a, const image::Plane<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}
inline bool same_bits(const Pictures& a, const Pictures& b) {
  for (std::size_t frame = 0; frame < a.size(); ++frame) {
    for (std::size_t v = 0; v < a[frame].views.size(); ++v) {
      const kernels::ViewBuffers &x = a[frame].views[v], &y = b[frame].views[v];
      if (!same_bits(x.radiance, y.radiance) || !same_bits(x.depth_m, y.depth_m) ||
          !same_bits(x.surface_id, y.surface_id) || !same_bits(x.rate, y.rate))
        return false;
    }
  }
  return true;
}

}  // namespace macula::test
