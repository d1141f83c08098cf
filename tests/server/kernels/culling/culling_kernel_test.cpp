#include "server/kernels/culling/culling_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/kernels/culling/keep_lights.h"
#include "server/kernels/registry.h"
#include "server/scene/load.h"
#include "tests/conformance/test_scenes.h"

namespace macula::kernels::culling {
namespace {

std::shared_ptr<const SceneFrame> lambert_room() {
  scene::Scene scene = test::closed_room();
  scene.settings.ambient = Rgb{0.0F};
  scene.materials[2].emission = Rgb{0.0F};  // direct light is then free of chance
  return test::frame_of(std::move(scene));
}

View view_of(int side) {
  return test::view_on(foveation::make_uniform_grid(test::display(side, 70.0)));
}

KernelOptions options(Mode mode, int bounces) {
  KernelOptions options;
  options.mode = mode;
  options.samples_per_cell = 4;
  options.area_light_samples = 4;
  options.ambient_samples = 0;
  options.lambert_only = true;
  options.bounces = bounces;
  return options;
}

/// Frames of one session.
class Session {
 public:
  explicit Session(const Kernel& kernel, int threads = 2) : kernel_(kernel), scheduler_(threads) {}
  const ViewBuffers& next(const SceneFrame& scene, const View& view, std::uint64_t seed = 1) {
    const FoveationMap map({{view.grid, view.gaze, DVec2{1e-3}}}, foveation::RateModel{});
    report_ =
        kernel_.render({{&view, 1}, map, frame_++, seed}, scene, history_, scheduler_, buffers_);
    return buffers_.views.front();
  }
  const FrameReport& report() const { return report_; }
  History& history() { return history_; }

 private:
  const Kernel& kernel_;
  TileScheduler scheduler_;
  History history_;
  FrameBuffers buffers_;
  FrameReport report_;
  std::uint64_t frame_ = 0;
};

struct Mean {
  double value = 0.0, error = 0.0;
};
/// Over frames, which are independent in mode Exact.
Mean mean_luminance(const Kernel& kernel, const SceneFrame& scene, const View& view, int frames) {
  Session session(kernel);
  double sum = 0.0, square = 0.0;
  for (int i = 0; i < frames; ++i) {
    const DVec3 mean = test::mean(session.next(scene, view).radiance);
    const double luminance = image::luminance(Rgb(mean));
    sum += luminance, square += luminance * luminance;
  }
  const double mean = sum / frames;
  return {mean, std::sqrt(std::max(square / frames - mean * mean, 0.0) / (frames - 1))};
}

// The light of one bounce, by lights that were made, culled and shared among classes, against
// paths.
TEST(CullingKernel, GivesTheLightOfOneBounceOnAverageAndUnweightedCullingDoesNot) {
  const auto scene = lambert_room();
  const View view = view_of(12);
  const auto brute = *make_kernel("brute", options(Mode::Exact, 1));
  const auto direct = *make_kernel("brute", options(Mode::Exact, 0));
  Config config = make_config(options(Mode::Exact, 1));
  config.kept = 256;
  const Mean wanted = mean_luminance(*brute, *scene, view, 60);
  const Mean without = mean_luminance(*direct, *scene, view, 60);
  const Mean got = mean_luminance(CullingKernel(config), *scene, view, 60);
  const double indirect = wanted.value - without.value;
  const double error = std::hypot(wanted.error, got.error);
  EXPECT_GT(indirect, 20.0 * error) << "there is something to find";
  EXPECT_LT(std::abs(got.value - wanted.value), 4.0 * error);
  config.weights = CullWeights::None;
  const Mean unweighted = mean_luminance(CullingKernel(config), *scene, view, 60);
  EXPECT_GT(std::abs(unweighted.value - wanted.value), 4.0 * error + 0.1 * indirect);
}

TEST(CullingKernel, WithoutBouncesIsKernelRay) {
  const auto scene = lambert_room();
  const View view = view_of(24);
  const auto ray = *make_kernel("ray", options(Mode::Exact, 0));
  const auto culling = *make_kernel("culling", options(Mode::Exact, 0));
  const Plane<Rgb> a = Session(*ray).next(*scene, view).radiance;
  const Plane<Rgb> b = Session(*culling).next(*scene, view).radiance;
  EXPECT_TRUE(std::ranges::equal(a.pixels(), b.pixels()));
}

TEST(CullingKernel, OneThreadAndManyGiveTheSameBits) {
  const auto scene = lambert_room();
  const View view = view_of(48);
  for (const Mode mode : {Mode::Exact, Mode::Fast}) {
    const CullingKernel kernel(make_config(options(mode, 1)));
    Session one(kernel, 1), many(kernel, 4);
    for (int frame = 0; frame < 2; ++frame) {
      const Plane<Rgb> a = one.next(*scene, view).radiance;
      const Plane<Rgb> b = many.next(*scene, view).radiance;
      EXPECT_TRUE(std::ranges::equal(a.pixels(), b.pixels())) << frame;
    }
  }
}

double total(const Plane<Rgb>& picture) {
  return image::luminance(Rgb(test::mean(picture)));
}

TEST(CullingKernel, RecoversFromABlackPictureWithinTwoFrames) {
  const auto scene = lambert_room();
  const View view = view_of(48);
  const CullingKernel kernel(make_config(options(Mode::Fast, 1)));
  Session session(kernel);
  double settled = 0.0;
  for (int i = 0; i < 8; ++i) settled = total(session.next(*scene, view).radiance);
  auto& memory = dynamic_cast<CullingHistory&>(*session.history().record);
  for (Rgb& value : memory.views.front().light.pixels()) value = Rgb{0.0F};
  for (auto& root : memory.pictures.front().roots.pixels()) root = {};
  for (float& frames : memory.pictures.front().frames.pixels()) frames = 1.0F;  // a first one
  std::ranges::fill(memory.brought, 0.0F);
  session.next(*scene, view);
  EXPECT_NEAR(total(session.next(*scene, view).radiance), settled, 0.1 * settled);
}

TEST(CullingKernel, KeepsTheMeanWithinAFewPercentOfAllLights) {
  const auto scene = lambert_room();
  const View view = view_of(48);
  Config config = make_config(options(Mode::Fast, 1));
  const auto after = [&](const Config& some) {
    const CullingKernel kernel(some);
    Session session(kernel);
    double sum = 0.0;
    for (int i = 0; i < 8; ++i) sum += total(session.next(*scene, view).radiance) / 8.0;
    return sum;
  };
  const double culled = after(config);
  config.kept = 1 << 20;
  const double all = after(config);
  EXPECT_NEAR(culled, all, 0.02 * all);
}

TEST(CullingKernel, IsDefinedWhereThereIsNothing) {
  scene::Scene dark = test::closed_room();
  dark.lights.clear();
  dark.materials[2].emission = Rgb{0.0F};
  dark.settings.ambient = Rgb{0.0F};
  const auto scene = test::frame_of(std::move(dark));
  for (const Mode mode : {Mode::Exact, Mode::Fast}) {
    const CullingKernel kernel(make_config(options(mode, 1)));
    Session session(kernel);
    EXPECT_EQ(total(session.next(*scene, view_of(16)).radiance), 0.0);
    EXPECT_EQ(session.report().non_finite_samples, 0U);
  }
  const auto lit = test::frame_of(test::small_room());
  View away = view_of(16);
  away.world_from_view.rotation = glm::angleAxis(3.14159, DVec3{0.0, 1.0, 0.0});
  Config config = make_config(options(Mode::Fast, 1));
  config.kept = 1;
  const CullingKernel kernel(config);
  Session session(kernel);
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(std::isfinite(total(session.next(*lit, away).radiance)));
}

TEST(CullingKernel, LightsDistanceFieldsToo) {
  const auto loaded = scene::load_scene("columns");
  ASSERT_TRUE(loaded);
  const auto scene = *SceneFrame::create(*loaded);
  View view = view_of(32);
  view.world_from_view = scene->pose().world_from_view.front();
  const CullingKernel with(make_config(options(Mode::Fast, 1)));
  const CullingKernel without(make_config(options(Mode::Fast, 0)));
  const double lit = total(Session(with).next(*scene, view).radiance);
  EXPECT_GT(lit, 1.05 * total(Session(without).next(*scene, view).radiance));
}

}  // namespace
}  // namespace macula::kernels::culling
