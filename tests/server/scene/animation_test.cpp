#include "server/scene/animation.h"

#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/scene/settle.h"

namespace macula::scene {
namespace {

constexpr double kPi = std::numbers::pi;

SceneTime at_s(double seconds) {
  return {units::from_s(seconds)};
}
DQuat turn_y(double angle_rad) {
  return glm::angleAxis(angle_rad, DVec3{0.0, 1.0, 0.0});
}
double angle_of(const DQuat& rotation) {
  return 2.0 *
         std::atan2(glm::length(DVec3(rotation.x, rotation.y, rotation.z)), std::abs(rotation.w));
}

Track<DVec3> ramp(Interpolation interpolation) {
  return {interpolation, {1.0, 3.0}, {DVec3{0.0}, DVec3{4.0, 0.0, 0.0}}};
}

/// One triangle under one joint that turns about Y once in four seconds, 2 m off its axis.
Scene carousel() {
  Scene scene;
  scene.materials.resize(1);
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  scene.meshes = {mesh};
  Joint joint;
  joint.rotations = {
      Interpolation::Linear,
      {0.0, 1.0, 2.0, 3.0, 4.0},
      {turn_y(0.0), turn_y(0.5 * kPi), turn_y(kPi), turn_y(1.5 * kPi), turn_y(2.0 * kPi)}};
  joint.period = std::chrono::seconds{4};
  scene.joints = {joint};
  scene.instances = {{0, glm::translate(DMat4{1.0}, DVec3{2.0, 0.0, 0.0}), 0}};
  return scene;
}

DVec3 origin_of(const Scene& scene, SceneTime time) {
  return DVec3(pose_at(scene, time).world_from_object[0][3]);
}

TEST(Track, HoldsTheFirstAndTheLastKeyOutsideThem) {
  for (const auto interpolation : {Interpolation::Step, Interpolation::Linear}) {
    EXPECT_EQ(value_at(ramp(interpolation), -5.0), DVec3(0.0));
    EXPECT_EQ(value_at(ramp(interpolation), 3.0), DVec3(4.0, 0.0, 0.0));
    EXPECT_EQ(value_at(ramp(interpolation), 99.0), DVec3(4.0, 0.0, 0.0));
  }
}

TEST(Track, StepsKeepTheEarlierKeyAndLinesGoBetween) {
  EXPECT_EQ(value_at(ramp(Interpolation::Step), 2.9), DVec3(0.0));
  EXPECT_EQ(value_at(ramp(Interpolation::Linear), 1.5), DVec3(1.0, 0.0, 0.0));
}

// A cubic is its own Hermite spline: t^3 between keys at 1 and 3 with slopes 3 t^2.
TEST(Track, ACubicSplineReproducesACubic) {
  const auto cubic = [](double t) { return DVec3{t * t * t, -t * t, t}; };
  const auto slope = [](double t) { return DVec3{3.0 * t * t, -2.0 * t, 1.0}; };
  const DVec3 unused{777.0};  // tangents before the first and after the last key
  const Track<DVec3> track{Interpolation::CubicSpline,
                           {1.0, 3.0},
                           {unused, cubic(1), slope(1), slope(3), cubic(3), unused}};
  for (double t = 1.0; t < 3.0; t += 0.125) {
    EXPECT_NEAR(glm::length(value_at(track, t) - cubic(t)), 0.0, 1e-12) << t;
  }
  EXPECT_EQ(value_at(track, 0.0), cubic(1));
  EXPECT_EQ(value_at(track, 4.0), cubic(3));
}

TEST(Track, RotationsTurnAtConstantSpeedTheShorterWay) {
  // 350 degrees one way are 10 the other; and q and -q are the same rotation.
  const DQuat to = turn_y(350.0 * kPi / 180.0);
  for (const DQuat& end : {to, -to}) {
    const Track<DQuat> track{Interpolation::Linear, {0.0, 1.0}, {turn_y(0.0), end}};
    for (const double u : {0.1, 0.25, 0.5, 0.9}) {
      const DQuat q = value_at(track, u);
      EXPECT_NEAR(angle_of(q), u * 10.0 * kPi / 180.0, 1e-12);
      EXPECT_NEAR(glm::length(q), 1.0, 1e-15);
      EXPECT_LT(DVec3(q * DVec3{0, 0, 1}).x, 0.0) << "turns towards -10 degrees";
    }
  }
}

TEST(Track, ARotationSplineStaysAUnitQuaternion) {
  const DQuat none(0.0, 0.0, 0.0, 0.0);
  const Track<DQuat> track{
      Interpolation::CubicSpline, {0.0, 2.0}, {none, turn_y(0.0), none, none, turn_y(2.0), none}};
  for (double t = 0.0; t <= 2.0; t += 0.1) {
    EXPECT_NEAR(glm::length(value_at(track, t)), 1.0, 1e-15);
  }
  // Without tangents the halves mirror each other: the middle is half the turn.
  EXPECT_NEAR(angle_of(value_at(track, 1.0)), 1.0, 1e-12);
}

TEST(SecondsInto, WrapsAroundThePeriodAlsoBeforeZero) {
  const Nanoseconds period = std::chrono::seconds{4};
  EXPECT_EQ(seconds_into(at_s(9.5), period), 1.5);
  EXPECT_EQ(seconds_into(at_s(-0.5), period), 3.5);
  EXPECT_EQ(seconds_into(at_s(8.0), period), 0.0);
  EXPECT_EQ(seconds_into(at_s(9.5), Nanoseconds{0}), 9.5);
}

// 250 years are 7.9e18 ns: a double would have rounded the remainder to about a microsecond.
TEST(SecondsInto, LosesNoNanosecondInCenturies) {
  const Nanoseconds period{3'000'000'007};
  const Nanoseconds::rep turns = 2'600'000'000;
  const SceneTime late{Nanoseconds{turns * period.count() + 1'234'567'891}};
  EXPECT_EQ(seconds_into(late, period), seconds_into({Nanoseconds{1'234'567'891}}, period));
  const SceneTime last{Nanoseconds{std::numeric_limits<Nanoseconds::rep>::min()}};
  EXPECT_GE(seconds_into(last, period), 0.0);
  EXPECT_LT(seconds_into(last, period), 3.000000007);
}

TEST(ScenePose, AJointCarriesAnInstanceRoundItsAxis) {
  const Scene scene = carousel();
  for (const double t : {0.0, 0.5, 1.0, 2.75, 4.0, 101.25, -3.0}) {
    const double angle = 2.0 * kPi * t / 4.0;
    const DVec3 expected{2.0 * std::cos(angle), 0.0, -2.0 * std::sin(angle)};
    EXPECT_NEAR(glm::length(origin_of(scene, at_s(t)) - expected), 0.0, 1e-12) << t;
  }
}

TEST(ScenePose, JointsMultiplyFromTheRootWithBaseBeforeTracks) {
  Scene scene = carousel();
  scene.joints[0].parent_from_base = glm::translate(DMat4{1.0}, DVec3{10.0, 0.0, 0.0});
  Joint child;
  child.parent = 0;
  child.translations = {Interpolation::Linear, {0.0, 1.0}, {DVec3{0.0}, DVec3{0.0, 5.0, 0.0}}};
  child.scale = DVec3{3.0};
  scene.joints.push_back(child);
  scene.instances[0].joint = 1;
  ASSERT_TRUE(check_motion(scene));
  // At 1 s the root has turned +x to -z; the child stands 5 m up and scales its 2 m to 6.
  EXPECT_NEAR(glm::length(origin_of(scene, at_s(1.0)) - DVec3(10.0, 5.0, -6.0)), 0.0, 1e-12);
}

TEST(ScenePose, LightsAndCamerasHangFromJointsToo) {
  Scene scene = carousel();
  scene.lights.resize(2);
  scene.lights[0].kind = LightKind::Spot;
  scene.lights[0].position = {1.0, 2.0, 0.0};
  scene.lights[0].direction = {1.0F, 0.0F, 0.0F};
  scene.lights[0].joint = 0;
  scene.lights[1].position = {7.0, 0.0, 0.0};
  scene.cameras.resize(1);
  scene.cameras[0].parent_from_view.position = {0.0, 0.0, -1.0};
  scene.cameras[0].joint = 0;
  const ScenePose pose = pose_at(scene, at_s(1.0));
  const std::vector<Light> lights = lights_at(scene, pose);
  EXPECT_NEAR(glm::length(lights[0].position - DVec3(0.0, 2.0, -1.0)), 0.0, 1e-12);
  EXPECT_NEAR(glm::length(lights[0].direction - Vec3(0.0F, 0.0F, -1.0F)), 0.0F, 1e-6F);
  EXPECT_FALSE(lights[0].joint.has_value());
  EXPECT_EQ(lights[1].position, DVec3(7.0, 0.0, 0.0));
  EXPECT_NEAR(glm::length(pose.world_from_view[0].position - DVec3(-1.0, 0.0, 0.0)), 0.0, 1e-12);
  const DVec3 ahead = pose.world_from_view[0].transform_direction({0.0, 0.0, -1.0});
  EXPECT_NEAR(glm::length(ahead - DVec3(-1.0, 0.0, 0.0)), 0.0, 1e-12);
}

/// carousel() with a mesh whose vertices rise by a meter in the first second and fall in the next.
Scene breathing() {
  Scene scene = carousel();
  Mesh& mesh = scene.meshes[0];
  std::vector<Vec3> raised = mesh.positions;
  for (Vec3& p : raised) p.y += 1.0F;
  mesh.normals = std::vector<Vec3>(3, Vec3{0, 0, 1});
  mesh.deformation.times_s = {0.0, 1.0, 2.0};
  mesh.deformation.positions = {mesh.positions, raised, mesh.positions};
  const std::vector<Vec3> sideways(3, Vec3{0, 1, 0});
  mesh.deformation.normals = {mesh.normals, sideways, mesh.normals};
  mesh.deformation.period = std::chrono::seconds{2};
  return scene;
}

TEST(ScenePose, AMeshChangesShapeLinearlyAndKeepsUnitNormals) {
  const Scene scene = breathing();
  ASSERT_TRUE(check_motion(scene));
  for (const double t : {0.25, 1.75, 2.25, -0.25}) {
    const ScenePose pose = pose_at(scene, at_s(t));
    EXPECT_FLOAT_EQ(pose.positions(scene, 0)[2].y, 1.25F) << t;
    EXPECT_NEAR(glm::length(pose.normals(scene, 0)[0]), 1.0F, 1e-6F);
  }
}

TEST(ScenePose, ReposingReachesTheSameBitsAsPosingAfresh) {
  Scene scene = breathing();
  scene.instances.push_back({0, DMat4{1.0}});
  scene.lights.resize(3);
  scene.lights[1].joint = 0;
  const MovingParts moving = moving_parts(scene);
  ScenePose pose = pose_at(scene, at_s(17.3));
  std::vector<Light> lights = lights_at(scene, pose);
  for (const double t : {3.1, 0.0, -8.4, 1.0}) {
    repose(scene, moving, at_s(t), pose);
    const ScenePose fresh = pose_at(scene, at_s(t));
    EXPECT_EQ(pose.time, fresh.time);
    EXPECT_EQ(pose.world_from_object, fresh.world_from_object);
    EXPECT_EQ(pose.shapes[0].positions, fresh.shapes[0].positions);
    EXPECT_EQ(pose.shapes[0].normals, fresh.shapes[0].normals);
    carry_lights(scene, moving.lights, pose, lights);
    EXPECT_EQ(lights[1].position, lights_at(scene, fresh)[1].position);
  }
}

TEST(MovingParts, NamesWhatTracksReachAndNothingElse) {
  Scene scene = breathing();
  Joint still;
  Joint below;
  below.parent = 0;
  scene.joints.push_back(still);
  scene.joints.push_back(below);
  Mesh rigid = scene.meshes[0];
  rigid.deformation = {};
  scene.meshes.push_back(rigid);
  scene.instances = {{1, DMat4{1.0}}, {1, DMat4{1.0}, 1}, {1, DMat4{1.0}, 2}, {0, DMat4{1.0}}};
  scene.lights.resize(2);
  scene.lights[1].joint = 2;
  const MovingParts moving = moving_parts(scene);
  EXPECT_EQ(moving.instances, (std::vector<Index>{2, 3}));
  EXPECT_EQ(moving.lights, (std::vector<Index>{1}));
  EXPECT_EQ(moving.meshes, (std::vector<Index>{0}));
  EXPECT_TRUE(moving.cameras.empty());
  EXPECT_TRUE(moving_parts(Scene{}).none());
}

TEST(InstanceMotion, MapsPointsOfThePastToThePresent) {
  Scene scene = carousel();
  scene.instances.push_back({0, DMat4{1.0}});
  const ScenePose before = pose_at(scene, at_s(0.2)), now = pose_at(scene, at_s(0.7));
  const auto motions = motions_between(before, now);
  ASSERT_EQ(motions.size(), 1U);
  EXPECT_EQ(motions[0].instance, 0U);
  const DVec4 corner{1.0, 0.0, 0.0, 1.0};
  const DVec4 moved = motions[0].now_from_before * (before.world_from_object[0] * corner);
  EXPECT_NEAR(glm::length(moved - now.world_from_object[0] * corner), 0.0, 1e-12);
  const auto rigid = rigid_motion(motions[0].now_from_before);
  ASSERT_TRUE(rigid);
  EXPECT_NEAR(angle_of(rigid->rotation), 0.25 * kPi, 1e-9);
  EXPECT_FALSE(rigid_motion(glm::scale(DMat4{1.0}, DVec3{1.0, 1.001, 1.0})));
  EXPECT_FALSE(rigid_motion(glm::scale(DMat4{1.0}, DVec3{-1.0, 1.0, 1.0})));
}

// A scene in centimeters is the scene in meters a hundred times smaller, joints and all.
TEST(Settle, ScalesWhatJointsCarryThroughTheirRoots) {
  Scene scene = breathing();
  scene.lights.resize(2);
  scene.lights[0].position = scene.lights[1].position = {100.0, 0.0, 0.0};
  scene.lights[0].joint = 0;
  scene.cameras.resize(1);
  scene.cameras[0].parent_from_view.position = {0.0, 50.0, 0.0};
  scene.cameras[0].joint = 0;
  const ScenePose before = pose_at(scene, at_s(0.6));
  const std::vector<Light> lit = lights_at(scene, before);
  const Bounds bounds = scene.bounds(at_s(0.6));
  SideFile side;
  side.meters_per_unit = 0.01;
  settle(scene, side);
  const ScenePose after = pose_at(scene, at_s(0.6));
  const std::vector<Light> lit_after = lights_at(scene, after);
  const Bounds smaller = scene.bounds(at_s(0.6));
  EXPECT_NEAR(glm::length(0.01 * bounds.minimum - smaller.minimum), 0.0, 1e-12);
  EXPECT_NEAR(glm::length(0.01 * bounds.maximum - smaller.maximum), 0.0, 1e-12);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(glm::length(0.01 * lit[i].position - lit_after[i].position), 0.0, 1e-12);
    EXPECT_FLOAT_EQ(lit_after[i].intensity.x, 1e-4F * lit[i].intensity.x);
  }
  EXPECT_NEAR(
      glm::length(0.01 * before.world_from_view[0].position - after.world_from_view[0].position),
      0.0, 1e-12);
}

TEST(SceneBounds, FollowTheMotion) {
  const Scene scene = breathing();
  EXPECT_NEAR(scene.bounds(at_s(0.0)).maximum.x, 3.0, 1e-12);
  EXPECT_NEAR(scene.bounds(at_s(2.0)).minimum.x, -3.0, 1e-12);
  EXPECT_NEAR(scene.bounds(at_s(1.0)).maximum.y, 2.0, 1e-6);
}

TEST(CheckMotion, NamesWhatDoesNotFit) {
  const auto fault_of = [](auto&& spoil) {
    Scene scene = breathing();
    spoil(scene);
    const Result<void> checked = check_motion(scene);
    return checked ? std::string() : checked.error().message();
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(fault_of([](Scene&) {}), "");
  EXPECT_NE(fault_of([](Scene& s) { s.joints[0].parent = 0; }).find("parent"), std::string::npos);
  EXPECT_NE(fault_of([](Scene& s) { s.joints[0].rotations.times_s[1] = 0.0; }).find("rise"),
            std::string::npos);
  EXPECT_NE(fault_of([](Scene& s) { s.joints[0].rotations.values.pop_back(); }).find("4 values"),
            std::string::npos);
  EXPECT_NE(fault_of([](Scene& s) {
              s.joints[0].rotations.values[2] = DQuat(0, 0, 0, 0);
            }).find("rotation"),
            std::string::npos);
  EXPECT_NE(fault_of([nan](Scene& s) { s.joints[0].translation.x = nan; }).find("rest"),
            std::string::npos);
  EXPECT_NE(fault_of([](Scene& s) { s.joints[0].period = Nanoseconds{-1}; }).find("period"),
            std::string::npos);
  EXPECT_NE(
      fault_of([](Scene& s) { s.meshes[0].deformation.positions[1].pop_back(); }).find("mesh 0"),
      std::string::npos);
  EXPECT_NE(fault_of([](Scene& s) { s.instances[0].joint = 3; }).find("no joint 3"),
            std::string::npos);
}

}  // namespace
}  // namespace macula::scene
