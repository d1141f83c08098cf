// Node animation from glTF: joints, tracks, interpolation, and the lies an animation can tell.
#include <cstring>
#include <numbers>

#include <gtest/gtest.h>

#include "gltf_file.h"
#include "server/scene/animation.h"
#include "server/scene/load.h"
#include "shared/math/hash.h"

namespace macula::scene {
namespace {

using test::replaced;
using test::TemporaryFolder;

std::string bytes_of(const std::vector<float>& values) {
  std::string bytes(values.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

/// The triangle under `nodes` (JSON), with one animation whose channels are `channels` and whose
/// samplers read accessor 2 (times) and 3 (values of `type`).
struct AnimatedFile {
  std::string nodes = R"([{"mesh":0}])";
  std::string channels = R"([{"sampler":0,"target":{"node":0,"path":"translation"}}])";
  std::string interpolation = "LINEAR";
  std::string type = "VEC3";
  std::vector<float> times{0, 2};
  std::vector<float> values{0, 0, 0, 4, 0, 0};
  int value_count = 2;

  Result<std::shared_ptr<const Scene>> load() const {
    const TemporaryFolder folder;
    folder.write("t.bin", test::triangle_bytes());
    folder.write("k.bin", bytes_of(times) + bytes_of(values));
    return load_scene(folder.write("moving.gltf", json()));
  }
  std::string json() const {
    const auto text = [](auto number) { return std::to_string(number); };
    const std::size_t split = 4 * times.size(), rest = 4 * values.size();
    std::string json =
        replaced(test::triangle_json(), R"("nodes":[{"mesh":0}])", R"("nodes":)" + nodes);
    json = replaced(json, R"("count":3,"type":"SCALAR"}])",
                    R"("count":3,"type":"SCALAR"},{"bufferView":2,"componentType":5126,"count":)" +
                        text(times.size()) +
                        R"(,"type":"SCALAR"},{"bufferView":3,"componentType":5126,"count":)" +
                        text(value_count) + R"(,"type":")" + type + R"("}])");
    json = replaced(json, R"("byteOffset":36,"byteLength":6}])",
                    R"("byteOffset":36,"byteLength":6},{"buffer":1,"byteLength":)" + text(split) +
                        R"(},{"buffer":1,"byteOffset":)" + text(split) + R"(,"byteLength":)" +
                        text(rest) + "}]");
    return replaced(json, R"("byteLength":44}]})",
                    R"("byteLength":44},{"uri":"k.bin","byteLength":)" + text(split + rest) +
                        R"(}],"animations":[{"channels":)" + channels +
                        R"(,"samplers":[{"input":2,"output":3,"interpolation":")" + interpolation +
                        R"("}]}]})");
  }
};

SceneTime at(double seconds) {
  return {Nanoseconds(std::llround(1e9 * seconds))};
}

/// World position of the triangle's corner (1, 0, 0).
DVec3 corner(const Scene& scene, double seconds) {
  const ScenePose pose = pose_at(scene, at(seconds));
  return DVec3(pose.world_from_object[0] * DVec4(1.0, 0.0, 0.0, 1.0));
}

void expect_near(const DVec3& value, const DVec3& expected) {
  EXPECT_NEAR(glm::length(value - expected), 0.0, 1e-6)
      << value.x << " " << value.y << " " << value.z;
}

TEST(GltfAnimation, OneThatLeadsBeyondWhatFloatsHoldIsRefused) {
  AnimatedFile file;
  file.values = {0, 0, 0, 2e7F, 0, 0};
  const auto far_away = file.load();
  ASSERT_FALSE(far_away);
  EXPECT_NE(far_away.error().message().find("10,000 km"), std::string::npos);
  EXPECT_NE(far_away.error().message().find("moving.gltf"), std::string::npos);
  file.values = {0, 0, 0, 9e6F, 0, 0};
  EXPECT_TRUE(file.load());
  // Two nodes, each within the limit, that come to 1.2e7 m together.
  file.nodes = R"([{"children":[1],"translation":[6e6,0,0]},{"mesh":0}])";
  file.channels = R"([{"sampler":0,"target":{"node":1,"path":"translation"}}])";
  file.values = {0, 0, 0, 6e6F, 0, 0};
  EXPECT_FALSE(file.load());
  file.interpolation = "CUBICSPLINE";  // tangents of 1e9 m/s swing far out between the keys
  file.nodes = R"([{"mesh":0}])";
  file.channels = R"([{"sampler":0,"target":{"node":0,"path":"translation"}}])";
  file.values = {0, 0, 0, 0, 0, 0, 1e9F, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0};
  file.value_count = 6;
  EXPECT_FALSE(file.load());
  file.values[6] = 1.0F;
  EXPECT_TRUE(file.load());
}

TEST(Motion, TheFarthestReachBoundsEveryMoment) {
  Scene scene;
  scene.meshes.resize(1);
  scene.meshes[0].positions = {{1, 2, 2}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    Joint joint;
    if (i > 0) joint.parent = i - 1;
    joint.parent_from_base = glm::rotate(DMat4(1.0), 0.7 * i, glm::normalize(DVec3(1, i, 2)));
    joint.translations.times_s = {0.0, 1.0, 2.0};
    joint.translations.values = {{0, 0, 0}, {2.0 + i, 1, 0}, {0, -1, 3}};
    joint.scales.times_s = {0.0, 2.0};
    joint.scales.values = {{1, 1, 1}, {0.5, 1.5, 1.0}};
    scene.joints.push_back(joint);
  }
  scene.instances.push_back({0, glm::translate(DMat4(1.0), DVec3(0, 1, 0)), 3});
  const double bound = farthest_reach_m(scene);
  double farthest = 0.0;
  for (int k = 0; k <= 40; ++k) {
    const ScenePose pose = pose_at(scene, at(0.05 * k));
    farthest =
        std::max(farthest, glm::length(DVec3(pose.world_from_object[0] * DVec4(1, 2, 2, 1))));
  }
  EXPECT_LE(farthest, bound);
  EXPECT_LT(bound, 5.0 * farthest);
  scene.joints.clear();
  scene.instances[0].joint.reset();
  EXPECT_NEAR(farthest_reach_m(scene), 4.0, 1e-9) << "3 for the vertex, 1 for the shift";
}

TEST(GltfAnimation, ALinearTranslationMovesTheMeshAndBeginsAgain) {
  const auto scene = AnimatedFile{}.load();
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_TRUE((*scene)->warnings.empty());
  ASSERT_EQ((*scene)->joints.size(), 1U);
  EXPECT_TRUE(check_motion(**scene));
  expect_near(corner(**scene, 0.0), {1, 0, 0});
  expect_near(corner(**scene, 0.5), {2, 0, 0});
  expect_near(corner(**scene, 2.5), {2, 0, 0});
}

TEST(GltfAnimation, AStepHoldsTheEarlierKey) {
  AnimatedFile file;
  file.interpolation = "STEP";
  const auto scene = file.load();
  ASSERT_TRUE(scene) << scene.error().message();
  expect_near(corner(**scene, 1.9), {1, 0, 0});
}

// Hermite at the middle of [0, 2] between 0 and 4 with tangents 0 in and out: (0 + 4) / 2 = 2; at a
// quarter, h01 = 3 u^2 - 2 u^3 = 0.15625, so 0.625.
TEST(GltfAnimation, ACubicSplineFollowsItsTangents) {
  AnimatedFile file;
  file.interpolation = "CUBICSPLINE";
  file.value_count = 6;
  file.values = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0, 0, 0};
  const auto scene = file.load();
  ASSERT_TRUE(scene) << scene.error().message();
  expect_near(corner(**scene, 1.0), {3, 0, 0});
  expect_near(corner(**scene, 0.5), {1.625, 0, 0});
}

// A quarter turn about +Z over two seconds: after one second (1, 0, 0) stands at 45 degrees.
TEST(GltfAnimation, RotationsTurnOnTheShorterArc) {
  AnimatedFile file;
  const float half = std::numbers::sqrt2_v<float> / 2.0F;
  file.channels = R"([{"sampler":0,"target":{"node":0,"path":"rotation"}}])";
  file.type = "VEC4";
  file.values = {0, 0, 0, 1, 0, 0, half, half};
  const auto scene = file.load();
  ASSERT_TRUE(scene) << scene.error().message();
  expect_near(corner(**scene, 1.0), {half, half, 0});
}

// Still parent (moved by 10 in y, doubled), moving node (0 to 4 in x), still child (moved by 1 in
// z) that holds the mesh: (1, 0, 0) -> (1, 0, 1) -> (1 + x, 0, 1) -> doubled and lifted.
TEST(GltfAnimation, StillNodesAboveAndBelowAMovingOneKeepTheirPlace) {
  AnimatedFile file;
  file.nodes =
      R"([{"translation":[0,10,0],"scale":[2,2,2],"children":[1]},{"children":[2]},{"mesh":0,"translation":[0,0,1]}])";
  file.channels = R"([{"sampler":0,"target":{"node":1,"path":"translation"}}])";
  const auto scene = file.load();
  ASSERT_TRUE(scene) << scene.error().message();
  expect_near(corner(**scene, 0.0), {2, 10, 2});
  expect_near(corner(**scene, 1.0), {6, 10, 2});
}

TEST(GltfAnimation, LightsAndCamerasRideOnMovingNodes) {
  AnimatedFile file;
  file.nodes =
      R"([{"children":[1,2]},{"mesh":0},{"camera":0,"extensions":{"KHR_lights_punctual":{"light":0}}}])";
  std::string json = file.json();
  json = replaced(json, R"("asset":)",
                  R"("cameras":[{"type":"perspective","perspective":{"yfov":0.75,"znear":0.1}}],)"
                  R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"point"}]}},"asset":)");
  const TemporaryFolder folder;
  folder.write("t.bin", test::triangle_bytes());
  folder.write("k.bin", bytes_of(file.times) + bytes_of(file.values));
  const auto scene = load_scene(folder.write("moving.gltf", json));
  ASSERT_TRUE(scene) << scene.error().message();
  const ScenePose pose = pose_at(**scene, at(1.0));
  expect_near(lights_at(**scene, pose).at(0).position, {2, 0, 0});
  expect_near(pose.world_from_view.at(0).position, {2, 0, 0});
}

TEST(GltfAnimation, ANodeThatMirrorsAtRestKeepsItsFrontWhileItMoves) {
  AnimatedFile file;
  file.nodes = R"([{"mesh":0,"scale":[-1,1,1]}])";
  const auto scene = file.load();
  ASSERT_TRUE(scene) << scene.error().message();
  const ScenePose pose = pose_at(**scene, at(1.0));
  const Mesh& mesh = (*scene)->meshes[(*scene)->instances[0].mesh];
  const auto moved = [&](Index i) {
    return DVec3(pose.world_from_object[0] * DVec4(DVec3(mesh.positions[i]), 1.0));
  };
  const UVec3 t = mesh.triangles[0];
  EXPECT_GT(cross(moved(t.y) - moved(t.x), moved(t.z) - moved(t.x)).z, 0.0);
  EXPECT_GT(glm::determinant(DMat3(pose.world_from_object[0])), 0.0);
}

TEST(GltfAnimation, MorphWeightsAreIgnoredWithAWarning) {
  AnimatedFile file;
  file.channels = R"([{"sampler":0,"target":{"node":0,"path":"weights"}}])";
  const auto scene = file.load();
  ASSERT_TRUE(scene) << scene.error().message();
  ASSERT_EQ((*scene)->warnings.size(), 1U);
  EXPECT_NE((*scene)->warnings[0].find("morph"), std::string::npos);
}

struct Lie {
  const char* name;
  const char* says;
  void (*tell)(AnimatedFile&);
};
std::ostream& operator<<(std::ostream& out, const Lie& lie) {
  return out << lie.name;
}
class LyingAnimation : public testing::TestWithParam<Lie> {};

TEST_P(LyingAnimation, GivesOneClearLine) {
  AnimatedFile file;
  GetParam().tell(file);
  const auto scene = file.load();
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message().find(GetParam().says), std::string::npos)
      << scene.error().message();
  EXPECT_NE(scene.error().message().find("animation 0 channel 0"), std::string::npos);
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
const Lie kLies[] = {
    {"TimesFall", "key 1",
     [](AnimatedFile& file) {
       file.times = {2, 1};
     }},
    {"TimesStandStill", "key 1",
     [](AnimatedFile& file) {
       file.times = {1, 1};
     }},
    {"TimeIsNegative", "key 0",
     [](AnimatedFile& file) {
       file.times = {-1, 1};
     }},
    {"TimeIsNotANumber", "key 1",
     [](AnimatedFile& file) {
       file.times = {0, kNan};
     }},
    {"ValueIsNotANumber", "value 1", [](AnimatedFile& file) { file.values[4] = kNan; }},
    {"ValuesAreTooFew", "1 values for 2 keys", [](AnimatedFile& file) { file.value_count = 1; }},
    {"SplineLacksTangents", "2 values for 2 keys",
     [](AnimatedFile& file) { file.interpolation = "CUBICSPLINE"; }},
    {"InterpolationIsUnknown", "BEZIER", [](AnimatedFile& file) { file.interpolation = "BEZIER"; }},
    {"NodeIsMissing", "node 9",
     [](AnimatedFile& file) {
       file.channels = R"([{"sampler":0,"target":{"node":9,"path":"scale"}}])";
     }},
    {"SamplerIsMissing", "sampler 5",
     [](AnimatedFile& file) {
       file.channels = R"([{"sampler":5,"target":{"node":0,"path":"scale"}}])";
     }},
    {"RotationHasNoDirection", "value 0",
     [](AnimatedFile& file) {
       file.channels = R"([{"sampler":0,"target":{"node":0,"path":"rotation"}}])";
       file.type = "VEC4";
       file.values = {0, 0, 0, 0, 0, 0, 0, 1};
     }},
};
INSTANTIATE_TEST_SUITE_P(Each, LyingAnimation, testing::ValuesIn(kLies),
                         [](const auto& lie) { return std::string(lie.param.name); });

TEST(GltfAnimation, RandomDamageEndsInAnErrorOrInSoundMotion) {
  const TemporaryFolder folder;
  folder.write("t.bin", test::triangle_bytes());
  AnimatedFile file;
  file.interpolation = "CUBICSPLINE";
  file.value_count = 6;
  file.values.assign(18, 0.5F);
  const std::string json = file.json(), keys = bytes_of(file.times) + bytes_of(file.values);
  int refused = 0;
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    std::string damaged_json = json, damaged_keys = keys;
    for (std::uint64_t k = 0; k < 1 + seed % 3; ++k) {
      const std::uint64_t hash = math::hash_combine(seed, k);
      std::string& damaged = hash % 2 == 0 ? damaged_json : damaged_keys;
      damaged[(hash >> 8) % damaged.size()] = static_cast<char>(hash >> 40);
    }
    folder.write("k.bin", damaged_keys);
    const auto scene = load_scene(folder.write("moving.gltf", damaged_json));
    refused += scene ? 0 : 1;
    if (!scene) continue;
    EXPECT_TRUE(check_motion(**scene));
    EXPECT_FALSE((*scene)->instances.empty());
    pose_at(**scene, at(0.7));
  }
  EXPECT_GT(refused, 150);
  EXPECT_LT(refused, 600);
}

TEST(GltfAnimation, TwoChannelsForOnePartOfANodeAreRefused) {
  AnimatedFile file;
  const std::string one = R"({"sampler":0,"target":{"node":0,"path":"translation"}})";
  file.channels = "[" + one + "," + one + "]";
  const auto scene = file.load();
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message().find("two channels"), std::string::npos);
}

}  // namespace
}  // namespace macula::scene
