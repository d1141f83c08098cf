// Broken scene files of our own making, one lie each, as a user meets them: the program says on one
// line what is wrong and where, and ends with 2, within 2 s of processor time and 512 MB.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "tests/server/scene/gltf_file.h"
#include "tests/support/measured_program.h"

namespace macula {
namespace {

using scene::test::little_endian;
using scene::test::replaced;
using scene::test::TemporaryFolder;
using scene::test::triangle_bytes;
using scene::test::triangle_glb;
using scene::test::triangle_json;

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kInstrumented = true;
#else
constexpr bool kInstrumented = false;
#endif

/// Writes its files and returns the path to give to --scene.
using Make = std::function<std::string(const TemporaryFolder&)>;
struct Broken {
  const char* name;
  const char* says;  ///< what the message contains
  Make make;
};
std::ostream& operator<<(std::ostream& out, const Broken& broken) {
  return out << broken.name;
}

// ---- glTF ----

constexpr const char* kNode = R"("nodes":[{"mesh":0}])";
constexpr const char* kPaint = R"({"name":"paint"})";
constexpr const char* kVertices = R"("bufferView":0,"componentType":5126,"count":3,"type":"VEC3")";

std::string with_json(const TemporaryFolder& folder, const std::string& json) {
  folder.write("t.bin", triangle_bytes());
  return folder.write("t.gltf", json);
}
/// The good triangle with one text replaced.
Make lie(std::string from, std::string to) {
  return [from, to](const TemporaryFolder& folder) {
    return with_json(folder, replaced(triangle_json(), from, to));
  };
}
Make with_bytes(std::string bytes) {
  return [bytes](const TemporaryFolder& folder) {
    folder.write("t.bin", bytes);
    return folder.write("t.gltf", triangle_json());
  };
}
Make glb(std::string bytes) {
  return [bytes](const TemporaryFolder& folder) { return folder.write("t.glb", bytes); };
}
Make with_image(std::string bytes) {
  return [bytes](const TemporaryFolder& folder) {
    folder.write("a.png", bytes);
    return with_json(folder,
                     replaced(triangle_json(), kPaint,
                              R"({"emissiveTexture":{"index":0}}],"images":[{"uri":"a.png"}],)"
                              R"("textures":[{"source":0})"));
  };
}

std::string big_endian(std::uint32_t value) {
  std::string bytes = little_endian(value);
  std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

std::string png_chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  std::uint32_t crc = 0xFFFFFFFFU;  // of PNG, bit by bit
  for (const char c : body) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xEDB88320U : 0U);
  }
  return big_endian(static_cast<std::uint32_t>(data.size())) + body + big_endian(~crc);
}

/// A signature and a header, then nothing. `kind`: "\x08\x06" is RGBA of 8 bits, "\x01\0" black and
/// white.
std::string png_header(std::uint32_t side, const std::string& kind = "\x08\x06") {
  return "\x89PNG\r\n\x1a\n" +
         png_chunk("IHDR", big_endian(side) + big_endian(side) + kind + std::string(3, '\0'));
}

/// `count` zero bytes in zlib's format: one literal, then copies of 258 bytes from 1 back, in
/// deflate's fixed codes (RFC 1951): 13 bits each.
std::string compressed_zeros(std::uint32_t count) {
  std::string bytes = "\x78\x01";
  unsigned pending = 0, filled = 0;
  const auto put = [&](unsigned bits, unsigned length) {  // first bit lowest
    for (; length > 0; --length, bits >>= 1) {
      pending |= (bits & 1) << filled;
      if (++filled < 8) continue;
      bytes.push_back(static_cast<char>(pending));
      pending = filled = 0;
    }
  };
  put(0b011, 3);       // last block, fixed codes
  put(0b00001100, 8);  // literal 0
  std::uint32_t left = count - 1;
  for (; left >= 258; left -= 258) put(0b00000'10100011, 13);  // length 258 (285), distance 1
  for (; left > 0; --left) put(0b00001100, 8);
  put(0, 7);                                             // end of block
  put(0, 7);                                             // whatever completes the byte
  return bytes + big_endian((count % 65521) << 16 | 1);  // Adler-32
}

/// A sound picture of 67 million black pixels in 53 kB.
std::string png_bomb() {
  const std::uint32_t side = 8192;
  return png_header(side, std::string("\x01\0", 2)) +
         png_chunk("IDAT", compressed_zeros(side * (side / 8 + 1))) + png_chunk("IEND", "");
}

/// Start of image and one frame header of 65500 x 65500.
std::string jpeg_header() {
  return std::string(
      "\xFF\xD8\xFF\xC0\x00\x11\x08\xFF\xDC\xFF\xDC\x03\x01\x22\x00\x02\x11\x01\x03\x11\x01", 21);
}

std::string chain_of_nodes(int count) {
  std::string nodes = R"("nodes":[)";
  for (int i = 1; i < count; ++i) nodes += R"({"children":[)" + std::to_string(i) + "]},";
  return nodes + R"({"mesh":0}])";
}

/// One mesh of many triangles under many nodes, each of `node`.
std::string crowd(const TemporaryFolder& folder, const std::string& node, int nodes,
                  int triangles) {
  std::string bytes = triangle_bytes();
  bytes.resize(36);
  for (int i = 0; i < triangles; ++i) bytes += std::string("\0\0\1\0\2\0", 6);
  std::string list = R"("nodes":[)", roots;
  for (int i = 0; i < nodes; ++i) {
    if (i > 0) list.push_back(','), roots.push_back(',');
    list.append(node);
    roots.append(std::to_string(i));
  }
  std::string json = replaced(triangle_json(), kNode, list + "]");
  json = replaced(json, R"("nodes":[0])", R"("nodes":[)" + roots + "]");
  json = replaced(json, R"("componentType":5123,"count":3)",
                  R"("componentType":5123,"count":)" + std::to_string(3 * triangles));
  json = replaced(json, R"("byteOffset":36,"byteLength":6)",
                  R"("byteOffset":36,"byteLength":)" + std::to_string(6 * triangles));
  json = replaced(json, R"("byteLength":44)", R"("byteLength":)" + std::to_string(bytes.size()));
  folder.write("t.bin", bytes);
  return folder.write("t.gltf", json);
}

std::string linked_elsewhere(const TemporaryFolder& folder) {
  std::filesystem::create_symlink("/etc/passwd", folder.path() + "/t.bin");
  return folder.write("t.gltf", triangle_json());
}

Make with_side_file(std::string text) {
  return [text](const TemporaryFolder& folder) {
    folder.write("t.macula.toml", text);
    return with_json(folder, triangle_json());
  };
}

// ---- what assimp reads ----

Make file(std::string name, std::string text) {
  return [name, text](const TemporaryFolder& folder) { return folder.write(name, text); };
}
constexpr const char* kCorners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

Make obj_with_mtl(std::string material) {
  return [material](const TemporaryFolder& folder) {
    folder.write("big.png", png_header(32768));
    folder.write("m.mtl", "newmtl a\nKd 1 1 1\n" + material + "\n");
    return folder.write("m.obj", std::string("mtllib m.mtl\n") + kCorners + "usemtl a\nf 1 2 3\n");
  };
}

std::string ply(const std::string& vertices, const std::string& body) {
  return "ply\nformat ascii 1.0\nelement vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
         "property list uchar int vertex_indices\nend_header\n" +
         body;
}

std::string collada(const std::string& nodes) {
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" )"
         R"(version="1.4.1"><asset/><library_nodes><node id="n">)" +
         nodes +
         R"(</node></library_nodes><library_visual_scenes><visual_scene id="s"><node id="r">)"
         R"(<instance_node url="#n"/></node></visual_scene></library_visual_scenes>)"
         R"(<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

const float kNan = std::numeric_limits<float>::quiet_NaN();

const Broken kBroken[] = {
    {"GltfIsEmpty", "t.gltf", file("t.gltf", "")},
    {"GltfIsCutOff", "t.gltf", file("t.gltf", triangle_json().substr(0, 200))},
    {"GltfNestsAMillionDeep", "levels deep", file("t.gltf", std::string(1'000'000, '['))},
    {"GlbIsCutOff", "t.glb", glb(triangle_glb().substr(0, 400))},
    {"GlbPromisesMoreThanThereIs", "promises",
     glb(triangle_glb().replace(8, 4, little_endian(1u << 30)))},
    {"GlbIsSomethingElse", "t.glb", glb(std::string(5000, 'x'))},
    {"CountWraps", "accessor 0",
     lie(kVertices,
         R"("bufferView":0,"componentType":5126,"count":4611686018427387904,"type":"VEC3")")},
    {"CountIsOneTooMany", "accessor 0",
     lie(kVertices, R"("bufferView":0,"componentType":5126,"count":4,"type":"VEC3")")},
    {"StrideIsTooShort", "byteStride",
     lie(R"("byteOffset":0,"byteLength":36)", R"("byteOffset":0,"byteLength":36,"byteStride":4)")},
    {"BufferIsLongerThanItsFile", "t.bin",
     lie(R"("byteLength":44)", R"("byteLength":4611686018427387904)")},
    {"IndexIsOutOfRange", "index 2 is 9",
     with_bytes(triangle_bytes({0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 9}))},
    {"VertexIsNotANumber", "vertex 1", with_bytes(triangle_bytes({0, 0, 0, 1, kNan, 0, 0, 1, 0}))},
    {"MatrixOverflows", "t.gltf",
     lie(kNode,
         R"("nodes":[{"scale":[1e200,1,1],"children":[1]},{"mesh":0,"scale":[1e200,1,1]}])")},
    {"NumberOverflows", "t.gltf",
     lie(R"("count":3,"type":"SCALAR")", R"("count":1e999,"type":"SCALAR")")},
    {"NodesFormACycle", "node 1",
     lie(kNode, R"("nodes":[{"mesh":0,"children":[1]},{"children":[2]},{"children":[1]}])")},
    {"NodeHasTwoParents", "node 3",
     lie(kNode, R"("nodes":[{"children":[1,2]},{"children":[3]},{"children":[3]},{"mesh":0}])")},
    {"NodesChainTooDeep", "too deep",
     [](const TemporaryFolder& folder) {
       return with_json(folder, replaced(triangle_json(), kNode, chain_of_nodes(5'000)));
     }},
    {"NodesAreAMillion", "objects",
     [](const TemporaryFolder& folder) {
       return with_json(folder, replaced(triangle_json(), kNode, chain_of_nodes(1'000'000)));
     }},
    {"CopiesMultiplyBeyondAllBounds", "triangles",
     [](const TemporaryFolder& folder) { return crowd(folder, R"({"mesh":0})", 50'000, 100'000); }},
    {"FlattenedCopiesMultiply", "triangles",
     [](const TemporaryFolder& folder) {
       return crowd(folder, R"({"mesh":0,"scale":[1,1,0]})", 50'000, 100'000);
     }},
    {"PathClimbsOut", "leaves", lie("t.bin", "../../../../../../etc/passwd")},
    {"PathIsAbsolute", "inside its own folder", lie("t.bin", "/etc/passwd")},
    {"PathIsADevice", "inside its own folder", lie("t.bin", "/dev/zero")},
    {"LinkLeadsOut", "leaves", linked_elsewhere},
    {"ImageIsHuge", "a.png", with_image(png_header(32768))},
    {"ImageOfTheLargestSizeIsCutOff", "a.png", with_image(png_header(8192))},
    {"ImageIsABomb", "67108864 pixels", with_image(png_bomb())},
    {"JpegIsHuge", "a.png", with_image(jpeg_header())},
    {"ImageIsNoImage", "neither PNG nor JPEG", with_image("GIF89a")},
    {"SceneIsFarAway", "meters_per_unit",
     lie(kNode, R"("nodes":[{"mesh":0,"translation":[1e20,0,0]}])")},
    {"SceneIsAFolder", "not a regular file",
     [](const TemporaryFolder& folder) {
       std::filesystem::create_directory(folder.path() + "/d.gltf");
       return folder.path() + "/d.gltf";
     }},
    {"SideFileIsNoToml", "t.macula.toml", with_side_file("meters_per_unit = [")},
    {"SideFileHasAnUnknownKey", "meters_per_uint", with_side_file("meters_per_uint = 1.0")},
    {"SideFileHasAnUnitOfZero", "meters_per_unit", with_side_file("meters_per_unit = 0.0")},
    {"SideFileHasNoNumber", "exposure_ev", with_side_file("exposure_ev = nan")},
    {"SideFileNestsDeep", "nested", with_side_file("a = " + std::string(5000, '['))},
    {"ObjIsEmpty", "m.obj", file("m.obj", "")},
    {"ObjIsBinary", "m.obj", file("m.obj", std::string(4096, '\x01'))},
    {"ObjIndexIsOutOfRange", "m.obj", file("m.obj", std::string(kCorners) + "f 1 2 77\n")},
    {"ObjVertexIsNotANumber", "finite", file("m.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n")},
    {"ObjHasNoFaces", "m.obj", file("m.obj", kCorners)},
    {"ObjNamesItsMaterialsElsewhere", "leaves",
     file("m.obj", std::string("mtllib ../../../../../etc/passwd\n") + kCorners + "f 1 2 3\n")},
    {"MtlTextureClimbsOut", "leaves", obj_with_mtl("map_Kd ../../../../../../etc/passwd")},
    {"MtlTextureIsMissing", "wood.png", obj_with_mtl("map_Kd wood.png")},
    {"MtlTextureIsHuge", "big.png", obj_with_mtl("map_Kd big.png")},
    {"PlyVertexCountLies", "m.ply",
     file("m.ply", ply("4000000000", "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"))},
    {"PlyIndexIsOutOfRange", "m.ply",
     file("m.ply", ply("3", "0 0 0\n1 0 0\n0 1 0\n3 0 1 70000\n"))},
    {"PlyIsCutOff", "m.ply", file("m.ply", ply("3", "0 0 0\n1 0"))},
    {"PlyHasNoEndOfHeader", "m.ply", file("m.ply", "ply\nformat ascii 1.0\nelement vertex 3\n")},
    {"StlCountLies", "m.stl",
     file("m.stl", std::string(80, ' ') + little_endian(0xFFFFFFFFU) + std::string(50, '\0'))},
    {"OffCountLies", "m.off", file("m.off", "OFF\n4000000000 4000000000 0\n0 0 0\n")},
    {"ColladaNodesContainThemselves", "m.dae",
     file("m.dae", collada(R"(<instance_node url="#n"/>)"))},
    {"ColladaIsCutOff", "m.dae", file("m.dae", collada("").substr(0, 150))},
    {"FbxIsCutOff", "m.fbx",
     file("m.fbx", std::string("Kaydara FBX Binary  \0\x1a\0\xe8\x1c\0\0\xff\xff\xff\xff", 31))},
    {"ThreeDsChunkLies", "m.3ds",
     file("m.3ds", std::string("\x4d\x4d\xff\xff\xff\x7f\x3d\x3d\xff\xff\xff\x7f", 12))},
    {"SuffixIsUnknown", ".obj", file("m.blend", "BLENDER")},
};

class BrokenScene : public testing::TestWithParam<Broken> {};

TEST_P(BrokenScene, EndsWithTwoAndOneLineWithinItsLimits) {
  const TemporaryFolder folder;
  const std::string scene = GetParam().make(folder);
  const test::MeasuredRun run = test::run_measured(
      {MACULA_SERVER_PROGRAM, "--explain", "--scene", scene, "--keys", folder.path() + "/k"});
  EXPECT_EQ(run.status, 2) << run.output;
  EXPECT_EQ(std::count(run.output.begin(), run.output.end(), '\n'), 1) << run.output;
  EXPECT_NE(run.output.find(GetParam().says), std::string::npos) << run.output;
  EXPECT_LT(run.output.size(), 700U) << run.output;
  if (!kInstrumented) {
    EXPECT_LE(run.cpu_s, 2.0);
    EXPECT_LE(run.peak_memory_mb, 512.0);
  }
  RecordProperty("cpu_ms", static_cast<int>(1e3 * run.cpu_s));
  RecordProperty("peak_mb", static_cast<int>(run.peak_memory_mb));
}
INSTANTIATE_TEST_SUITE_P(Each, BrokenScene, testing::ValuesIn(kBroken),
                         [](const auto& broken) { return std::string(broken.param.name); });

TEST(BrokenScene, TheGoodTriangleThatTheyAreMadeOfIsRead) {
  const TemporaryFolder folder;
  const auto run =
      test::run_measured({MACULA_SERVER_PROGRAM, "--explain", "--scene",
                          with_json(folder, triangle_json()), "--keys", folder.path() + "/k"});
  EXPECT_EQ(run.status, 0) << run.output;
  EXPECT_NE(run.output.find("1 triangles"), std::string::npos) << run.output;
}

}  // namespace
}  // namespace macula
