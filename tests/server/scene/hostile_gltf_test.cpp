// Files that lie: each must end in one line that names the file and says what is allowed; none may
// crash, hang or leave the scene's folder.
#include <sys/resource.h>

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "gltf_file.h"
#include "server/scene/load.h"
#include "shared/base/cpu_time.h"
#include "shared/base/text.h"
#include "shared/math/hash.h"
#include "shared/units/time.h"
#include "tests/support/fault_table.h"

namespace macula::scene {
namespace {

using test::replaced;
using test::TemporaryFolder;

void expect_clear_error(const Result<std::shared_ptr<const Scene>>& scene, const std::string& file,
                        const std::string& says) {
  ASSERT_FALSE(scene) << "the file was accepted";
  const std::string message = scene.error().message();
  EXPECT_EQ(scene.error().kind, base::ErrorKind::BadInput) << message;
  EXPECT_FALSE(scene.error().remedy.empty()) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_NE(message.find(file), std::string::npos) << message;
  EXPECT_NE(message.find(says), std::string::npos) << message;
}

struct Lie {
  const char* name;
  const char* from;  ///< text of triangle_json()
  const char* to;
  const char* says;  ///< part of the message
};
std::ostream& operator<<(std::ostream& out, const Lie& lie) {
  return out << lie.name;
}

class LyingGltf : public testing::TestWithParam<Lie> {};

TEST_P(LyingGltf, GivesOneClearLine) {
  const TemporaryFolder folder;
  folder.write("t.bin", test::triangle_bytes());
  const Lie& lie = GetParam();
  const std::string json = replaced(test::triangle_json(), lie.from, lie.to);
  expect_clear_error(load_scene(folder.write("lie.gltf", json)), "lie.gltf", lie.says);
}

/// All lies one after the other, with what they cost (each also has a test of its own).
struct HostileCosts {
  int files = 0, refused = 0;
  double longest_s = 0.0, peak_mb = 0.0;
};

constexpr const char* kVertices = R"("bufferView":0,"componentType":5126,"count":3,"type":"VEC3")";
constexpr const char* kIndices = R"("bufferView":1,"componentType":5123,"count":3,"type":"SCALAR")";
constexpr const char* kNode = R"("nodes":[{"mesh":0}])";
constexpr const char* kPaint = R"({"name":"paint"})";

const Lie kLies[] = {
    {"CountTimesStrideWraps", kVertices,
     R"("bufferView":0,"componentType":5126,"count":4611686018427387904,"type":"VEC3")",
     "accessor 0"},
    {"CountIsOneTooMany", kVertices,
     R"("bufferView":0,"componentType":5126,"count":4,"type":"VEC3")", "accessor 0"},
    {"CountIsZero", kVertices, R"("bufferView":0,"componentType":5126,"count":0,"type":"VEC3")",
     "count is 0"},
    {"IndexCountIsZero", kIndices,
     R"("bufferView":1,"componentType":5123,"count":0,"type":"SCALAR")", "accessor 1"},
    {"AccessorOffsetWraps", kVertices,
     R"("bufferView":0,"byteOffset":18446744073709551608,"componentType":5126,"count":3,"type":"VEC3")",
     "accessor 0"},
    {"ViewOffsetWraps", R"("byteOffset":0,"byteLength":36)",
     R"("byteOffset":18446744073709551608,"byteLength":36)", "buffer view 0"},
    {"ViewIsLongerThanItsBuffer", R"("byteOffset":0,"byteLength":36)",
     R"("byteOffset":0,"byteLength":45)", "buffer view 0"},
    {"StrideIsShorterThanAnElement", R"("byteOffset":0,"byteLength":36)",
     R"("byteOffset":0,"byteLength":36,"byteStride":8)", "byteStride 8"},
    {"StrideLeavesTheView", R"("byteOffset":0,"byteLength":36)",
     R"("byteOffset":0,"byteLength":36,"byteStride":20)", "accessor 0"},
    {"StrideIsHuge", R"("byteOffset":0,"byteLength":36)",
     R"("byteOffset":0,"byteLength":36,"byteStride":4294967296)", "lie.gltf"},
    {"PositionsAreVec2", kVertices,
     R"("bufferView":0,"componentType":5126,"count":3,"type":"VEC2")", "POSITION"},
    {"PositionsAreShorts", kVertices,
     R"("bufferView":0,"componentType":5123,"count":3,"type":"VEC3")", "5126"},
    {"IndicesAreFloats", kIndices,
     R"("bufferView":1,"componentType":5126,"count":3,"type":"SCALAR")", "indices"},
    {"IndicesAreWiderThanTheirBytes", kIndices,
     R"("bufferView":1,"componentType":5125,"count":3,"type":"SCALAR")", "accessor 1"},
    {"TypeIsUnknown", kVertices, R"("bufferView":0,"componentType":5126,"count":3,"type":"VEC9")",
     "lie.gltf"},
    {"ComponentTypeIsUnknown", kVertices,
     R"("bufferView":0,"componentType":1,"count":3,"type":"VEC3")", "lie.gltf"},
    {"SparseIndexLiesBeyondTheAccessor", kVertices,
     R"("bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":2,"indices":{"bufferView":0,"componentType":5121,"byteOffset":13},"values":{"bufferView":0}})",
     "sparse index 128"},
    {"SparseIndicesDoNotRise", kVertices,
     R"("bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":3,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":0}})",
     "sparse index 0 at place 1"},
    {"SparseCountIsMoreThanAll", kVertices,
     R"("bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":4,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":0}})",
     "1 to 3"},
    {"SparseCountIsNegative", kVertices,
     R"("bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":-1,"indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":0}})",
     "sparse count -1"},
    {"SparseIndicesPassTheirView", kVertices,
     R"("bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":3,"indices":{"bufferView":1,"componentType":5125},"values":{"bufferView":0}})",
     "sparse indices"},
    {"SparseValuesPassTheirView", kVertices,
     R"("bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":2,"indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":0,"byteOffset":16}})",
     "sparse values"},
    {"SparseOffsetIsNegative", kVertices,
     R"("bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":1,"componentType":5123,"byteOffset":-2},"values":{"bufferView":0}})",
     "byte -2"},
    {"SparseIndicesAreFloats", kVertices,
     R"("bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":1,"componentType":5126},"values":{"bufferView":0}})",
     "5126"},
    {"SparseViewIsMissing", kVertices,
     R"("bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":7,"componentType":5123},"values":{"bufferView":0}})",
     "buffer view 7"},
    {"ZerosWithoutEnd", kVertices,
     R"("componentType":5126,"count":4611686018427387904,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":0}})",
     "without a buffer view"},
    {"NoSuchAccessor", R"("POSITION":0)", R"("POSITION":99)", "accessor 99"},
    {"NegativeAccessor", R"("POSITION":0)", R"("POSITION":-1)", "lie.gltf"},
    {"NoPositions", R"("POSITION":0)", R"("NORMAL":0)", "POSITION"},
    {"NoSuchBufferView", kVertices,
     R"("bufferView":9,"componentType":5126,"count":3,"type":"VEC3")", "buffer view 9"},
    {"NoSuchBuffer", R"({"buffer":0,"byteOffset":0,)", R"({"buffer":7,"byteOffset":0,)",
     "buffer 7"},
    {"NoSuchMaterial", R"("material":0)", R"("material":7)", "material 7"},
    {"NoSuchMesh", kNode, R"("nodes":[{"mesh":5}])", "mesh 5"},
    {"NoSuchScene", R"("scene":0)", R"("scene":4)", "scene 4"},
    {"NoSuchRoot", R"("scenes":[{"nodes":[0]}])", R"("scenes":[{"nodes":[3]}])", "node 3"},
    {"NegativeRoot", R"("scenes":[{"nodes":[0]}])", R"("scenes":[{"nodes":[-1]}])", "node -1"},
    {"NoSuchChild", kNode, R"("nodes":[{"mesh":0,"children":[8]}])", "node 8"},
    {"NoSuchCamera", kNode, R"("nodes":[{"mesh":0,"camera":2}])", "camera 2"},
    {"NoSuchLight", kNode,
     R"("nodes":[{"mesh":0,"extensions":{"KHR_lights_punctual":{"light":3}}}])", "light 3"},
    {"NodeIsItsOwnChild", kNode, R"("nodes":[{"mesh":0,"children":[0]}])", "node 0"},
    {"NodesFormACycle", kNode,
     R"("nodes":[{"mesh":0,"children":[1]},{"children":[2]},{"children":[1]}])", "node 1"},
    {"NodeHasTwoParents", kNode,
     R"("nodes":[{"children":[1,2]},{"children":[3]},{"children":[3]},{"mesh":0}])", "node 3"},
    {"MatrixIsNotAffine", kNode,
     R"("nodes":[{"mesh":0,"matrix":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}])", "affine"},
    {"ScaleOverflows", kNode,
     R"("nodes":[{"scale":[1e200,1,1],"children":[1]},{"mesh":0,"scale":[1e200,1,1]}])",
     "overflows"},
    {"RotationIsZero", kNode, R"("nodes":[{"mesh":0,"rotation":[0,0,0,0]}])", "rotation"},
    {"SceneIsFartherThanFloatsReach", kNode, R"("nodes":[{"mesh":0,"translation":[1e20,0,0]}])",
     "meters_per_unit"},
    {"SceneIsEmpty", kNode, R"("nodes":[{}])", "no triangles"},
    {"BufferIsLongerThanItsFile", R"("byteLength":44)", R"("byteLength":4611686018427387904)",
     "t.bin"},
    {"BufferFileIsMissing", "t.bin", "missing.bin", "missing.bin"},
    {"BufferFileIsAFolder", "t.bin", ".", "no such file"},
    {"PathClimbsOut", "t.bin", "../../../../../../etc/passwd", "leaves"},
    {"PathClimbsOutEncoded", "t.bin", "%2e%2e/%2e%2e/%2e%2e/%2e%2e/%2e%2e/etc/passwd", "leaves"},
    {"PathIsAbsolute", "t.bin", "/etc/passwd", "inside its own folder"},
    {"PathIsADevice", "t.bin", "/dev/zero", "inside its own folder"},
    {"PathIsAUrl", "t.bin", "https://example.org/t.bin", "inside its own folder"},
    {"VersionIsOne", R"("version":"2.0")", R"("version":"1.0")", "version"},
    {"RequiresAnUnknownExtension", R"("scene":0,)",
     R"("scene":0,"extensionsRequired":["KHR_draco_mesh_compression"],)",
     "KHR_draco_mesh_compression"},
    {"NoSuchTexture", kPaint, R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":4}}})",
     "texture 4"},
    {"NoSuchImage", kPaint, R"({"emissiveTexture":{"index":0}}],"textures":[{"source":6})",
     "image 6"},
    {"NoSuchSampler", kPaint,
     R"({"emissiveTexture":{"index":0}}],"images":[{"uri":"a.png"}],"textures":[{"source":0,"sampler":3})",
     "sampler 3"},
    {"ImageIsMissing", kPaint,
     R"({"emissiveTexture":{"index":0}}],"images":[{"uri":"a.png"}],"textures":[{"source":0})",
     "image 0"},
    {"ImageClimbsOut", kPaint,
     R"({"emissiveTexture":{"index":0}}],"images":[{"uri":"../secret.png"}],"textures":[{"source":0})",
     "leaves"},
    {"ImageIsNoImage", kPaint,
     R"({"emissiveTexture":{"index":0}}],"images":[{"uri":"t.bin"}],"textures":[{"source":0})",
     "neither PNG nor JPEG"},
    {"ImageViewIsOutOfRange", kPaint,
     R"({"emissiveTexture":{"index":0}}],"images":[{"bufferView":77,"mimeType":"image/png"}],"textures":[{"source":0})",
     "77"},
    {"JsonEndsEarly", R"("buffers":[{"uri":"t.bin","byteLength":44}]})",
     R"("buffers":[{"uri":"t.b)", "lie.gltf"},
    {"NumberIsTooLarge", R"("count":3,"type":"SCALAR")", R"("count":1e999,"type":"SCALAR")",
     "lie.gltf"},
};
INSTANTIATE_TEST_SUITE_P(Each, LyingGltf, testing::ValuesIn(kLies),
                         [](const testing::TestParamInfo<Lie>& lie) { return lie.param.name; });

TEST(HostileGltf, EveryLieIsRefusedQuicklyAndWithLittleMemory) {
  const TemporaryFolder folder;
  folder.write("t.bin", test::triangle_bytes());
  HostileCosts costs;
  for (const Lie& lie : kLies) {
    const std::string json = replaced(test::triangle_json(), lie.from, lie.to);
    const double begin = units::to_s(base::thread_cpu_time());
    ++costs.files;
    costs.refused += load_scene(folder.write("lie.gltf", json)) ? 0 : 1;
    costs.longest_s = std::max(costs.longest_s, units::to_s(base::thread_cpu_time()) - begin);
  }
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  costs.peak_mb = static_cast<double>(used.ru_maxrss) / 1024.0;
  EXPECT_EQ(costs.refused, costs.files);
  EXPECT_GE(costs.files, 40);
  EXPECT_LE(costs.longest_s, 2.0);
  macula::test::note_fault(
      "hostile glTF files", ">= 40, each <= 2 s and <= 512 MB, error text",
      base::concat(costs.refused, " of ", costs.files, " refused, longest ", costs.longest_s,
                   " s of processor time, peak ", costs.peak_mb, " MB"));
}

TEST(HostileGltf, IndicesBeyondTheVerticesAreRefused) {
  const TemporaryFolder folder;
  folder.write("t.bin", test::triangle_bytes({0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 3}));
  expect_clear_error(load_scene(folder.write("i.gltf", test::triangle_json())), "i.gltf",
                     "index 2 is 3");
}

TEST(HostileGltf, VerticesThatAreNotNumbersAreRefused) {
  const TemporaryFolder folder;
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
    folder.write("t.bin", test::triangle_bytes({0, 0, 0, 1, bad, 0, 0, 1, 0}));
    expect_clear_error(load_scene(folder.write("n.gltf", test::triangle_json())), "n.gltf",
                       "vertex 1");
  }
}

TEST(HostileGltf, DeepNestingOfJsonIsRefusedBeforeItIsParsed) {
  const TemporaryFolder folder;
  const std::string deep(1'000'000, '[');
  expect_clear_error(load_scene(folder.write("deep.gltf", deep)), "deep.gltf", "levels deep");
}

TEST(HostileGltf, AMillionNodesInAChainAreRefused) {
  const TemporaryFolder folder;
  folder.write("t.bin", test::triangle_bytes());
  for (const auto& [count, says] :
       {std::pair{5'000, "too deep"}, std::pair{1'000'000, "objects"}}) {
    std::string nodes = R"("nodes":[)";
    for (int i = 1; i < count; ++i) nodes += R"({"children":[)" + std::to_string(i) + "]},";
    nodes += R"({"mesh":0}])";
    expect_clear_error(
        load_scene(folder.write("chain.gltf", replaced(test::triangle_json(), kNode, nodes))),
        "chain.gltf", says);
  }
}

TEST(HostileGltf, AnImageOfABillionPixelsIsRefusedByItsHeader) {
  // A PNG signature and an IHDR chunk of 32768 x 32768 pixels, then nothing.
  const TemporaryFolder folder;
  folder.write("t.bin", test::triangle_bytes());
  const std::string header(
      "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x80\0\0\0\x80\0\x08\x06\0\0\0\xa4\x52\x53\x7a", 33);
  folder.write("a.png", header);
  const std::string json = replaced(
      test::triangle_json(), kPaint,
      R"({"emissiveTexture":{"index":0}}],"images":[{"uri":"a.png"}],"textures":[{"source":0})");
  expect_clear_error(load_scene(folder.write("big.gltf", json)), "a.png", "");
}

TEST(HostileGltf, ALinkOutOfTheFolderIsRefused) {
  const TemporaryFolder folder, elsewhere;
  elsewhere.write("t.bin", test::triangle_bytes());
  std::filesystem::create_symlink(elsewhere.path() + "/t.bin", folder.path() + "/t.bin");
  expect_clear_error(load_scene(folder.write("link.gltf", test::triangle_json())), "link.gltf",
                     "leaves");
}

TEST(HostileGltf, EveryTruncationOfABinaryFileIsRefused) {
  const TemporaryFolder folder;
  const std::string whole = test::triangle_glb();
  for (std::size_t length = 0; length < whole.size(); length += 7) {
    const std::string path = folder.write("cut.glb", whole.substr(0, length));
    expect_clear_error(load_scene(path), "cut.glb", "");
  }
}

TEST(HostileGltf, ChunksThatPassTheEndOfABinaryFileAreRefused) {
  const TemporaryFolder folder;
  std::string file = test::triangle_glb();
  const std::size_t binary_length = file.size() - 44 - 8;
  // Eight bytes more than there are: what tinygltf alone would read past the end.
  file.replace(binary_length, 4, test::little_endian(52));
  expect_clear_error(load_scene(folder.write("chunk.glb", file)), "chunk.glb", "cut off");
}

/// What a scene promises, whatever the file said.
void expect_sound(const Scene& scene) {
  for (const Instance& instance : scene.instances) ASSERT_LT(instance.mesh, scene.meshes.size());
  for (const Mesh& mesh : scene.meshes) {
    ASSERT_LT(mesh.material, scene.materials.size());
    for (const Vec3& position : mesh.positions) ASSERT_TRUE(math::is_finite(position));
    for (const UVec3& t : mesh.triangles) {
      for (int corner = 0; corner < 3; ++corner) ASSERT_LT(t[corner], mesh.positions.size());
    }
  }
}

TEST(HostileGltf, RandomDamageEndsInAnErrorOrASoundScene) {
  const TemporaryFolder folder;
  const std::string whole = test::triangle_glb();
  int refused = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    std::string file = whole;
    for (std::uint64_t k = 0; k < 1 + seed % 3; ++k) {
      const std::uint64_t hash = math::hash_combine(seed, k);
      file[hash % file.size()] = static_cast<char>(hash >> 40);
    }
    const auto scene = load_scene(folder.write("damaged.glb", file));
    refused += scene ? 0 : 1;
    if (scene) {
      expect_sound(**scene);
    } else {
      EXPECT_NE(scene.error().message().find("damaged.glb"), std::string::npos);
    }
  }
  EXPECT_GT(refused, 500);
}

TEST(HostileGltf, MissingFilesAndUnknownNamesAreNamed) {
  const TemporaryFolder folder;
  expect_clear_error(load_scene(folder.path() + "/none.glb"), "none.glb", "no such file");
  expect_clear_error(load_scene("catedral"), "catedral", "cornell");
}

}  // namespace
}  // namespace macula::scene
