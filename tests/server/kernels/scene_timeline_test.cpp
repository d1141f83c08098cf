#include "server/kernels/scene_timeline.h"

#include <gtest/gtest.h>
#include <atomic>
#include <cmath>
#include <thread>

namespace macula::kernels {
namespace {

SceneTime at_ms(std::int64_t ms) {
  return {std::chrono::milliseconds{ms}};
}

/// A wall behind and a lamp (a card that shines to +z) carried along +x at 1 m/s, both facing the
/// viewer; a point light goes with the lamp. Repeats after 8 s.
std::shared_ptr<const scene::Scene> tram() {
  scene::Scene scene;
  scene.name = "tram";
  scene.materials.resize(2);
  scene.materials[1].emission = Rgb{3.0F};
  const auto card = [](float half, float z) {
    scene::Mesh mesh;
    mesh.positions = {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
  };
  scene.meshes = {card(50.0F, -10.0F), card(0.25F, -5.0F)};
  scene.meshes[1].material = 1;
  scene::Joint joint;
  joint.translations = {
      scene::Interpolation::Linear, {0.0, 8.0}, {DVec3{0.0}, DVec3{8.0, 0.0, 0.0}}};
  joint.period = std::chrono::seconds{8};
  scene.joints = {joint};
  scene.instances = {{0, DMat4{1.0}}, {1, DMat4{1.0}, 0}};
  scene.lights.resize(1);
  scene.lights[0].joint = 0;
  return std::make_shared<const scene::Scene>(std::move(scene));
}

/// Where the tram is seen: the x of the ray along -z that meets it, in steps of a centimeter.
bool tram_is_at(const SceneFrame& frame, double x_m) {
  const auto sees = [&](double x) {
    const auto hit = frame.triangles().intersect(
        visibility::Ray{Vec3(static_cast<float>(x), 0.1F, 0.0F), Vec3{0.0F, 0.0F, -1.0F}});
    return hit && hit->instance == 1;
  };
  return sees(x_m - 0.24) && sees(x_m + 0.24) && !sees(x_m - 0.26) && !sees(x_m + 0.26);
}

TEST(SceneTimeline, WhereNothingMovesThereIsOneFrameForAllTimes) {
  scene::Scene still = *tram();
  still.joints.clear();
  still.instances[1].joint.reset();
  still.lights[0].joint.reset();
  const auto timeline = *SceneTimeline::create(std::make_shared<scene::Scene>(std::move(still)));
  EXPECT_FALSE(timeline->moves());
  const auto first = *timeline->at({});
  for (const std::int64_t ms : {0, 1, 50'000, -3}) EXPECT_EQ(*timeline->at(at_ms(ms)), first);
  EXPECT_EQ(timeline->counters().moments, 1U);
  EXPECT_EQ(timeline->counters().frames, 1U);
}

TEST(SceneTimeline, AFrameShowsItsMoment) {
  const auto timeline = *SceneTimeline::create(tram());
  EXPECT_TRUE(timeline->moves());
  for (const std::int64_t ms :
       std::initializer_list<std::int64_t>{0, 1500, 7250, 8000, 17'000, -2000, 80'000'000'500}) {
    const auto frame = *timeline->at(at_ms(ms));
    const double x = static_cast<double>(((ms % 8000) + 8000) % 8000) * 1e-3;
    EXPECT_EQ(frame->time(), at_ms(ms));
    EXPECT_TRUE(tram_is_at(*frame, x)) << ms;
    EXPECT_NEAR(frame->lights().punctual()[0].position.x, x, 1e-9);
    ASSERT_EQ(frame->lights().emissive().size(), 2U);
    EXPECT_NEAR(frame->lights().emissive()[0].position.x, x - 0.25, 1e-6);
    EXPECT_NEAR(frame->surfaces().at(1, 0, {0.0F, 0.0F}).position.x, x - 0.25, 1e-6);
  }
}

TEST(SceneTimeline, TheFrameOfAMomentIsMadeOnceAndShared) {
  const auto timeline = *SceneTimeline::create(tram());
  const auto first = *timeline->at(at_ms(100));
  const auto second = *timeline->at(at_ms(200));
  EXPECT_EQ(*timeline->at(at_ms(200)), second);
  EXPECT_EQ(*timeline->at(at_ms(100)), first) << "somebody still has it";
  EXPECT_EQ(timeline->counters().moments, 2U);
}

TEST(SceneTimeline, AFrameThatNobodyReadsServesTheNextMoment) {
  const auto timeline = *SceneTimeline::create(tram());
  for (std::int64_t ms = 0; ms < 500; ++ms) EXPECT_TRUE(*timeline->at(at_ms(ms)));
  EXPECT_EQ(timeline->counters().moments, 500U);
  EXPECT_EQ(timeline->counters().frames, 1U);
}

TEST(SceneTimeline, AFrameInUseStaysAsItIs) {
  const auto timeline = *SceneTimeline::create(tram());
  const auto held = *timeline->at(at_ms(3000));
  for (std::int64_t ms = 0; ms < 100; ++ms) EXPECT_TRUE(*timeline->at(at_ms(60 * ms)));
  EXPECT_EQ(held->time(), at_ms(3000));
  EXPECT_TRUE(tram_is_at(*held, 3.0));
  EXPECT_NEAR(held->lights().emissive()[0].position.x, 2.75, 1e-6);
  EXPECT_EQ(timeline->counters().frames, 2U);
}

TEST(SceneTimeline, FramesOutliveTheirTimelineAndTheirScene) {
  std::shared_ptr<const SceneFrame> frame;
  {
    const auto timeline = *SceneTimeline::create(tram());
    frame = *timeline->at(at_ms(2000));
  }
  EXPECT_TRUE(tram_is_at(*frame, 2.0));
}

// Readers look at their frames while others make theirs; under the thread sanitizer a frame that
// were moved while in use would be a race, and without it a wrong place.
TEST(SceneTimeline, ReadersOnManyThreadsSeeTheirOwnMoments) {
  const auto timeline = *SceneTimeline::create(tram());
  std::atomic<int> wrong{0};
  std::vector<std::thread> readers;
  for (int reader = 0; reader < 4; ++reader) {
    readers.emplace_back([&, reader] {
      for (int i = 0; i < 100; ++i) {
        const std::int64_t ms = (reader % 2 == 0 ? 40 * i : 40 * (i + 3)) % 7000;
        const auto frame = *timeline->at(at_ms(ms));
        const double x = static_cast<double>(ms) * 1e-3;
        if (!tram_is_at(*frame, x) || frame->time() != at_ms(ms)) ++wrong;
      }
    });
  }
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_LE(timeline->counters().frames, 5U) << "one a reader and the newest";
}

TEST(SceneTimeline, AMovedLightListIsTheOneMadeAfresh) {
  const auto scene = tram();
  const auto timeline = *SceneTimeline::create(scene);
  const auto frame = *timeline->at(at_ms(1234));
  const lights::LightList fresh(*scene, scene::pose_at(*scene, at_ms(1234)), frame->materials());
  ASSERT_EQ(fresh.emissive().size(), frame->lights().emissive().size());
  for (std::uint32_t i = 0; i < fresh.emissive().size(); ++i) {
    EXPECT_EQ(fresh.emissive()[i].position, frame->lights().emissive()[i].position);
    EXPECT_EQ(fresh.pdf_per_m2(i), frame->lights().pdf_per_m2(i));
  }
  for (const Vec2 u : {Vec2{0.1F, 0.7F}, Vec2{0.8F, 0.2F}})
    EXPECT_EQ(fresh.sample_area(u).position, frame->lights().sample_area(u).position);
}

}  // namespace
}  // namespace macula::kernels
