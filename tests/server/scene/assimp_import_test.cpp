// Files that assimp reads, and the process it is confined to.
#include <csignal>
#include <cstring>
#include <thread>

#include <gtest/gtest.h>

#include "gltf_file.h"
#include "server/scene/assimp/isolate.h"
#include "server/scene/assimp/parcel.h"
#include "server/scene/load.h"
#include "shared/image/png.h"
#include "shared/math/hash.h"

namespace macula::scene {
namespace {

using test::TemporaryFolder;

constexpr const char* kSquare =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "usemtl paint\nf 1/1 2/2 3/3 4/4\n";

/// The square as OBJ with one material called paint.
Result<std::shared_ptr<const Scene>> load_square(const TemporaryFolder& folder,
                                                 const std::string& material) {
  folder.write("m.mtl", "newmtl paint\n" + material + "\n");
  return load_scene(folder.write("m.obj", std::string("mtllib m.mtl\n") + kSquare));
}

const Material& paint(const Scene& scene) {
  for (const Material& material : scene.materials) {
    if (material.name == "paint") return material;
  }
  ADD_FAILURE() << "no material called paint";
  return scene.materials.front();
}

bool warns_of(const Scene& scene, const std::string& words) {
  for (const std::string& warning : scene.warnings) {
    if (warning.find(words) != std::string::npos) return true;
  }
  return false;
}

TEST(ObjImport, PolygonsBecomeTrianglesAndTextureRowsRunDownwards) {
  const TemporaryFolder folder;
  const auto scene = load_square(folder, "Kd 0.5 0.4 0.3");
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ((*scene)->triangle_count(), 2U);
  const Mesh& mesh = (*scene)->meshes[0];
  ASSERT_EQ(mesh.positions.size(), 4U) << "shared corners are joined";
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(mesh.texcoords[i].y, 1.0F - mesh.positions[i].y) << "v = 0 is the top row";
  }
}

TEST(ObjImport, APlainDiffuseMaterialIsLambert) {
  const TemporaryFolder folder;
  const auto scene = load_square(folder, "Kd 0.5 0.4 0.3\nKs 0.5 0.5 0.5\nillum 1\nKe 3 2 1");
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ(paint(**scene).base_color, Rgb(0.5F, 0.4F, 0.3F));
  EXPECT_EQ(paint(**scene).specular, 0.0F);
  EXPECT_EQ(paint(**scene).emission, Rgb(3.0F, 2.0F, 1.0F));
  EXPECT_EQ((*scene)->emissive_triangle_count(), 2U);
}

// Ks = 0.5 is F0 = 0.04; Ns = 98 has alpha = sqrt(2 / 100), roughness its square root.
TEST(ObjImport, PhongsNumbersBecomeMetallicRoughness) {
  const TemporaryFolder folder;
  const auto scene = load_square(folder, "Kd 0.5 0.4 0.3\nKs 0.5 0.25 0\nNs 98\nillum 2");
  ASSERT_TRUE(scene) << scene.error().message();
  const Material& material = paint(**scene);
  EXPECT_EQ(material.metallic, 0.0F);
  EXPECT_NEAR(material.roughness, std::sqrt(std::sqrt(0.02)), 1e-6);
  EXPECT_NEAR(0.04F * material.specular * material.specular_color.x, 0.04F, 1e-6F);
  EXPECT_NEAR(0.04F * material.specular * material.specular_color.y, 0.02F, 1e-6F);
}

TEST(ObjImport, PhysicallyBasedNumbersWin) {
  const TemporaryFolder folder;
  const auto scene = load_square(folder, "Kd 1 1 1\nKs 0 0 0\nPr 0.3\nPm 0.9\nillum 2");
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_NEAR(paint(**scene).roughness, 0.3F, 1e-6F);
  EXPECT_NEAR(paint(**scene).metallic, 0.9F, 1e-6F);
}

TEST(ObjImport, AnOpacityTextureGoesIntoTheColoursFourthChannel) {
  const TemporaryFolder folder;
  image::Plane<Rgb8> wood(4, 2, Rgb8{10, 200, 30}), leaf(2, 2, Rgb8{255, 255, 255});
  leaf(1, 0) = Rgb8{0, 0, 0};
  ASSERT_TRUE(image::write_png(folder.path() + "/wood.png", wood));
  ASSERT_TRUE(image::write_png(folder.path() + "/leaf.png", leaf));
  const auto scene = load_square(folder, "Kd 0 0 0\nmap_Kd wood.png\nmap_d leaf.png");
  ASSERT_TRUE(scene) << scene.error().message();
  const Material& material = paint(**scene);
  EXPECT_EQ(material.alpha_mode, AlphaMode::Mask);
  EXPECT_EQ(material.base_color, Rgb{1.0F}) << "black under a texture means the texture";
  const auto& pixels = (*scene)->images[material.base_color_texture.value().image].pixels;
  ASSERT_EQ(pixels.width(), 4);
  EXPECT_EQ(pixels(0, 0).g, 200);
  EXPECT_EQ(pixels(1, 0).a, 255);
  EXPECT_EQ(pixels(2, 0).a, 0);
  EXPECT_EQ(pixels(3, 1).a, 255);
}

TEST(ObjImport, TransparencyBlends) {
  const TemporaryFolder folder;
  const auto scene = load_square(folder, "Kd 1 1 1\nd 0.25");
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ(paint(**scene).alpha_mode, AlphaMode::Blend);
  EXPECT_NEAR(paint(**scene).alpha, 0.25F, 1e-6F);
}

TEST(ObjImport, WhatIsIgnoredOrMissingIsAWarning) {
  const TemporaryFolder folder;
  const auto bumpy = load_square(folder, "Kd 1 1 1\nmap_Bump bump.png");
  ASSERT_TRUE(bumpy) << bumpy.error().message();
  EXPECT_TRUE(warns_of(**bumpy, "bump"));
  const auto bare = load_scene(folder.write("n.obj", std::string("mtllib none.mtl\n") + kSquare));
  ASSERT_TRUE(bare) << bare.error().message();
  EXPECT_TRUE(warns_of(**bare, "none.mtl"));
}

TEST(PlyImport, ColouredMeshesBecomeGreyLambertWithAWarning) {
  const TemporaryFolder folder;
  const auto scene = load_scene(folder.write(
      "m.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 255 0 0\n1 0 0 255 0 0\n1 1 0 255 0 0\n0 1 0 255 0 0\n4 0 1 2 3\n"));
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ((*scene)->triangle_count(), 2U);
  EXPECT_EQ((*scene)->materials.at(0).base_color, Rgb{0.8F});
  EXPECT_EQ((*scene)->materials.at(0).specular, 0.0F);
  EXPECT_TRUE(warns_of(**scene, "colours of vertices"));
  EXPECT_TRUE(warns_of(**scene, "no materials"));
}

TEST(StlImport, BothKindsGiveTheSameTriangle) {
  const TemporaryFolder folder;
  const auto text = load_scene(folder.write(
      "a.stl",
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop\nendfacet\nendsolid a\n"));
  std::string bytes(80, ' ');
  bytes += test::little_endian(1);
  const float numbers[12] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
  bytes.append(reinterpret_cast<const char*>(numbers), sizeof numbers);
  bytes.append(2, '\0');
  const auto binary = load_scene(folder.write("b.stl", bytes));
  ASSERT_TRUE(text) << text.error().message();
  ASSERT_TRUE(binary) << binary.error().message();
  EXPECT_EQ((*text)->meshes[0].positions, (*binary)->meshes[0].positions);
  EXPECT_EQ((*text)->meshes[0].triangles, (*binary)->meshes[0].triangles);
}

constexpr const char* kCollada =
    R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">)"
    R"(<asset><unit meter="0.5" name="half"/><up_axis>Z_UP</up_axis></asset>)"
    R"(<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="9">)"
    R"(0 0 0 1 0 0 0 1 0</float_array><technique_common><accessor source="#pa" count="3" stride="3">)"
    R"(<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>)"
    R"(</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/>)"
    R"(</vertices><triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p>)"
    R"(</triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">)"
    R"(<node id="n"><translate>0 0 4</translate><instance_geometry url="#g"/></node></visual_scene>)"
    R"(</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";

// Z up and half a meter a unit: four units up are two meters along +Y.
TEST(ColladaImport, UnitAndUpAxisAreTheFilesOwn) {
  const TemporaryFolder folder;
  const auto scene = load_scene(folder.write("m.dae", kCollada));
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ((*scene)->triangle_count(), 1U);
  EXPECT_NEAR((*scene)->bounds().minimum.y, 2.0, 1e-6);
  EXPECT_NEAR((*scene)->bounds().maximum.x, 0.5, 1e-6);
}

// Centimeters by its own word; Phong's exponent 98 as for MTL, not assimp's guess from it.
constexpr const char* kFbx = R"(; FBX 7.3.0 project file
FBXHeaderExtension:  {
FBXHeaderVersion: 1003
FBXVersion: 7300
Creator: "by hand"
}
GlobalSettings:  {
Version: 1000
Properties70:  {
P: "UnitScaleFactor", "double", "Number", "",1
}
}
Objects:  {
Geometry: 1001, "Geometry::g", "Mesh" {
Vertices: *9 {
a: 0,0,0,100,0,0,0,100,0
}
PolygonVertexIndex: *3 {
a: 0,1,-3
}
GeometryVersion: 124
LayerElementMaterial: 0 {
Version: 101
Name: ""
MappingInformationType: "AllSame"
ReferenceInformationType: "IndexToDirect"
Materials: *1 {
a: 0
}
}
Layer: 0 {
Version: 100
LayerElement:  {
Type: "LayerElementMaterial"
TypedIndex: 0
}
}
}
Model: 1002, "Model::m", "Mesh" {
Version: 232
Properties70:  {
P: "Lcl Translation", "Lcl Translation", "", "A",0,200,0
}
}
Material: 1003, "Material::paint", "" {
Version: 102
ShadingModel: "phong"
MultiLayer: 0
Properties70:  {
P: "DiffuseColor", "Color", "", "A",0.5,0.25,0.125
P: "SpecularColor", "Color", "", "A",0.5,0.5,0.5
P: "ShininessExponent", "Number", "", "A",98
P: "EmissiveColor", "Color", "", "A",0,0,0
}
}
}
Connections:  {
C: "OO",1002,0
C: "OO",1001,1002
C: "OO",1003,1002
}
)";

TEST(FbxImport, UnitAndMaterialAreTheFilesOwn) {
  const TemporaryFolder folder;
  const auto scene = load_scene(folder.write("m.fbx", kFbx));
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ((*scene)->settings.meters_per_unit, 0.01);
  EXPECT_NEAR((*scene)->bounds().minimum.y, 2.0, 1e-6);
  EXPECT_NEAR((*scene)->bounds().maximum.x, 1.0, 1e-6);
  EXPECT_NEAR(paint(**scene).base_color.y, 0.25F, 1e-6F);
  EXPECT_NEAR(paint(**scene).roughness, std::sqrt(std::sqrt(0.02)), 1e-6);
  EXPECT_TRUE(warns_of(**scene, "0.01 m"));
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

TEST(AssimpImport, RandomDamageEndsInAnErrorOrASoundScene) {
  const TemporaryFolder folder;
  const std::pair<const char*, std::string> whole[] = {
      {"d.obj", std::string("mtllib d.mtl\n") + kSquare},
      {"d.ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
       "float "
       "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 "
       "0\n"
       "3 0 1 2\n"},
      {"d.dae", kCollada},
      {"d.fbx", kFbx},
      {"d.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
  };
  int refused = 0;
  for (const auto& [name, text] : whole) {
    // A damaged PLY header makes assimp loop until its second of processor time is over.
    const std::size_t header = text.starts_with("ply") ? text.find("0 0 0") : 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      std::string file = text;
      for (std::uint64_t k = 0; k < 1 + seed % 4; ++k) {
        const std::uint64_t hash = math::hash_combine(seed, k);
        file[header + hash % (file.size() - header)] = static_cast<char>(hash >> 40);
      }
      const auto scene = load_scene(folder.write(name, file));
      refused += scene ? 0 : 1;
      if (scene) expect_sound(**scene);
      EXPECT_TRUE(scene || scene.error().message().find(name) != std::string::npos);
    }
  }
  EXPECT_GT(refused, 20);
}

// ---- the confined process ----

constexpr assimp::Limits kLimits{.memory_bytes = 64 << 20, .cpu_s = 1, .answer_bytes = 1 << 20};

std::string complaint(const std::function<Bytes()>& work) {
  const auto answer = assimp::run_isolated(work, kLimits, "x.obj");
  return answer ? "" : answer.error().message();
}

TEST(Isolate, HandsBackWhatTheWorkReturned) {
  const auto answer =
      assimp::run_isolated([] { return Bytes(300'000, std::byte{7}); }, kLimits, "x.obj");
  ASSERT_TRUE(answer);
  EXPECT_EQ(*answer, Bytes(300'000, std::byte{7}));
}

TEST(Isolate, WhateverHappensInsideComesBackAsAnErrorThatNamesTheFile) {
  const auto crash = [] {
    std::raise(SIGSEGV);
    return Bytes{};
  };
  const auto give_up = []() -> Bytes { throw std::runtime_error("no"); };
  const auto too_much = [] { return Bytes(2 << 20); };
  for (const std::string& message : {complaint(crash), complaint(give_up), complaint(too_much)}) {
    EXPECT_NE(message.find("x.obj"), std::string::npos) << message;
  }
}

TEST(Isolate, WorkWithoutEndIsEnded) {
  volatile bool forever = true;
  const std::string message = complaint([&forever] {
    while (forever) {
    }
    return Bytes{};
  });
  EXPECT_NE(message.find("processor time"), std::string::npos) << message;
}

TEST(Isolate, WritesNoFile) {
  const TemporaryFolder folder;
  const std::string path = folder.path() + "/written";
  complaint([&path] {
    std::signal(SIGXFSZ, SIG_IGN);
    std::ofstream(path) << "text" << std::flush;
    return Bytes{};
  });
  EXPECT_EQ(std::filesystem::exists(path) ? std::filesystem::file_size(path) : 0U, 0U);
}

TEST(Parcel, ComesBackWholeAndEveryCutIsAnError) {
  assimp::Parcel parcel;
  assimp::ParcelMaterial& material = parcel.materials.emplace_back();
  material.numbers.alpha = 0.5F;
  material.base_color = {"wood.png", 1, 2};
  assimp::ParcelMesh& mesh = parcel.meshes.emplace_back();
  mesh.positions = {{1, 2, 3}};
  mesh.triangles = {{0, 0, 0}};
  parcel.instances = {{.mesh = 0}};
  parcel.warnings = {"one", "two"};
  parcel.meters_per_unit = 0.01;
  const Bytes bytes = assimp::encode(Result<assimp::Parcel>(parcel));
  const auto back = assimp::decode(bytes, "x.obj");
  ASSERT_TRUE(back);
  EXPECT_EQ(back->materials.at(0).numbers.alpha, 0.5F);
  EXPECT_EQ(back->materials.at(0).base_color.path, "wood.png");
  EXPECT_EQ(back->meshes.at(0).positions, parcel.meshes[0].positions);
  EXPECT_EQ(back->warnings, parcel.warnings);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_FALSE(assimp::decode(cut, "x.obj")) << length;
  }
}

TEST(Parcel, AnErrorTravelsInItsPlace) {
  const Bytes bytes = assimp::encode(base::bad_input("what", "where", "remedy"));
  const auto back = assimp::decode(bytes, "x.obj");
  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().message(), "where: what (remedy)");
}

}  // namespace
}  // namespace macula::scene
