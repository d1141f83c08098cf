#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "gltf_file.h"
#include "server/scene/load.h"
#include "shared/codec/color.h"

namespace macula::scene {
namespace {

using test::replaced;
using test::TemporaryFolder;

/// Loads the triangle with changed JSON.
Result<std::shared_ptr<const Scene>> load_triangle(const TemporaryFolder& folder,
                                                   const std::string& json) {
  folder.write("t.bin", test::triangle_bytes());
  return load_scene(folder.write("t.gltf", json));
}

DVec3 moved(const Scene& scene, std::size_t instance, std::size_t vertex) {
  const Instance& placed = scene.instances[instance];
  return DVec3(placed.parent_from_object *
               DVec4(DVec3(scene.meshes[placed.mesh].positions[vertex]), 1.0));
}

TEST(GltfImport, TextAndBinaryFilesGiveTheSameTriangle) {
  const TemporaryFolder folder;
  const auto text = load_triangle(folder, test::triangle_json());
  const auto binary = load_scene(folder.write("t.glb", test::triangle_glb()));
  ASSERT_TRUE(text) << text.error().message();
  ASSERT_TRUE(binary) << binary.error().message();
  EXPECT_EQ((*text)->triangle_count(), 1U);
  EXPECT_EQ((*text)->meshes[0].positions, (*binary)->meshes[0].positions);
  EXPECT_EQ((*text)->meshes[0].triangles, (*binary)->meshes[0].triangles);
}

TEST(GltfImport, TransformsMultiplyDownTheTree) {
  // Parent: translate (1, 2, 3) and turn 90 degrees about +Y; child: scale 2. Vertex (1, 0, 0) goes
  // to 2 x, turned to -2 z, moved to (1, 2, 1).
  const TemporaryFolder folder;
  const auto scene = load_triangle(
      folder,
      replaced(
          test::triangle_json(), R"("nodes":[{"mesh":0}])",
          R"("nodes":[{"children":[1],"translation":[1,2,3],)"
          R"("rotation":[0,0.70710678118654752,0,0.70710678118654752]},{"mesh":0,"scale":[2,2,2]}])"));
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_NEAR(glm::length(moved(**scene, 0, 1) - DVec3(1, 2, 1)), 0.0, 1e-12);
}

TEST(GltfImport, AMeshUsedByTwoNodesIsStoredOnce) {
  const TemporaryFolder folder;
  std::string json = replaced(test::triangle_json(), R"("nodes":[{"mesh":0}])",
                              R"("nodes":[{"mesh":0},{"mesh":0,"translation":[5,0,0]}])");
  json = replaced(json, R"("scenes":[{"nodes":[0]}])", R"("scenes":[{"nodes":[0,1]}])");
  const auto scene = load_triangle(folder, json);
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ((*scene)->meshes.size(), 1U);
  EXPECT_EQ((*scene)->instances.size(), 2U);
  EXPECT_EQ((*scene)->triangle_count(), 2U);
  EXPECT_EQ((*scene)->unique_triangle_count(), 1U);
}

TEST(GltfImport, MirroringNodesKeepFrontsInFrontAndInstancesUnmirrored) {
  // The triangle faces +z; mirrored in x it still faces +z, so its world winding must be reversed.
  const TemporaryFolder folder;
  const auto scene =
      load_triangle(folder, replaced(test::triangle_json(), R"("nodes":[{"mesh":0}])",
                                     R"("nodes":[{"mesh":0,"scale":[-1,1,1]}])"));
  ASSERT_TRUE(scene) << scene.error().message();
  const Instance& instance = (*scene)->instances[0];
  EXPECT_GT(glm::determinant(DMat3(instance.parent_from_object)), 0.0);
  const UVec3 t = (*scene)->meshes[instance.mesh].triangles[0];
  const DVec3 a = moved(**scene, 0, t.x), b = moved(**scene, 0, t.y), c = moved(**scene, 0, t.z);
  EXPECT_GT(cross(b - a, c - a).z, 0.0);
  EXPECT_NEAR((*scene)->bounds().minimum.x, -1.0, 1e-12);
}

TEST(GltfImport, FlatteningNodesAreMovedThemselves) {
  const TemporaryFolder folder;
  const auto scene =
      load_triangle(folder, replaced(test::triangle_json(), R"("nodes":[{"mesh":0}])",
                                     R"("nodes":[{"mesh":0,"scale":[3,1,0]}])"));
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ((*scene)->instances[0].parent_from_object, DMat4{1.0});
  EXPECT_NEAR((*scene)->bounds().maximum.x, 3.0, 1e-12);
}

TEST(GltfImport, MaterialFactorsAndExtensionsArrive) {
  const TemporaryFolder folder;
  const auto scene = load_triangle(
      folder,
      replaced(
          test::triangle_json(), R"({"name":"paint"})",
          R"({"name":"paint","doubleSided":true,"alphaMode":"MASK","alphaCutoff":0.25,)"
          R"("pbrMetallicRoughness":{"baseColorFactor":[0.1,0.2,0.3,0.4],"metallicFactor":0.5,"roughnessFactor":0.75},)"
          R"("emissiveFactor":[1,0.5,0.25],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":17},)"
          R"("KHR_materials_specular":{"specularFactor":0}}})"));
  ASSERT_TRUE(scene) << scene.error().message();
  const Material& material = (*scene)->materials[0];
  EXPECT_EQ(material.base_color, Rgb(0.1F, 0.2F, 0.3F));
  EXPECT_EQ(material.alpha, 0.4F);
  EXPECT_EQ(material.metallic, 0.5F);
  EXPECT_EQ(material.roughness, 0.75F);
  EXPECT_EQ(material.emission, Rgb(17.0F, 8.5F, 4.25F));
  EXPECT_EQ(material.specular, 0.0F);
  EXPECT_EQ(material.alpha_mode, AlphaMode::Mask);
  EXPECT_EQ(material.alpha_cutoff, 0.25F);
  EXPECT_TRUE(material.double_sided);
  EXPECT_EQ((*scene)->emissive_triangle_count(), 1U);
}

TEST(GltfImport, SparseAccessorsReplaceElementsOfADenseOneOrOfZeros) {
  const TemporaryFolder folder;
  // Corner 2 moves to where bytes 12 to 23 say: (1, 0, 0); its index stands at byte 40.
  const std::string sparse =
      R"(,"sparse":{"count":1,"indices":{"bufferView":1,"byteOffset":4,"componentType":5123},)"
      R"("values":{"bufferView":0,"byteOffset":12}})";
  const std::string kind = R"("componentType":5126,"count":3,"type":"VEC3")";
  const auto dense = load_triangle(folder, replaced(test::triangle_json(), kind, kind + sparse));
  ASSERT_TRUE(dense) << dense.error().message();
  const std::vector<Vec3> replaced_corner = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  EXPECT_EQ((*dense)->meshes[0].positions, replaced_corner);
  const auto zeros = load_triangle(
      folder, replaced(test::triangle_json(), R"("bufferView":0,)" + kind, kind + sparse));
  ASSERT_TRUE(zeros) << zeros.error().message();
  const std::vector<Vec3> one_corner = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}};
  EXPECT_EQ((*zeros)->meshes[0].positions, one_corner);
}

TEST(GltfImport, CamerasAndPunctualLightsArriveInMeters) {
  // Half a meter a unit: positions halve, and intensity goes with length squared so that the
  // irradiance at the same place of the scene stays.
  const TemporaryFolder folder;
  std::string json = replaced(
      test::triangle_json(), R"("nodes":[{"mesh":0}])",
      R"("nodes":[{"mesh":0},{"camera":0,"name":"eye","translation":[0,2,8]},)"
      R"({"translation":[4,0,0],"extensions":{"KHR_lights_punctual":{"light":0}}}],)"
      R"("cameras":[{"type":"perspective","perspective":{"yfov":0.75,"znear":0.1}}],)"
      R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":8,"color":[1,0.5,0]}]}})");
  json = replaced(json, R"("scenes":[{"nodes":[0]}])", R"("scenes":[{"nodes":[0,1,2]}])");
  folder.write("t.macula.toml", "meters_per_unit = 0.5\n");
  const auto scene = load_triangle(folder, json);
  ASSERT_TRUE(scene) << scene.error().message();
  ASSERT_EQ((*scene)->cameras.size(), 1U);
  EXPECT_EQ((*scene)->cameras[0].name, "eye");
  EXPECT_NEAR((*scene)->cameras[0].vertical_fov.value(), 0.75, 1e-12);
  EXPECT_NEAR(glm::length((*scene)->cameras[0].parent_from_view.position - DVec3(0, 1, 4)), 0.0,
              1e-12);
  ASSERT_EQ((*scene)->lights.size(), 1U);
  EXPECT_EQ((*scene)->lights[0].intensity, Rgb(2.0F, 1.0F, 0.0F));
  EXPECT_NEAR((*scene)->lights[0].position.x, 2.0, 1e-12);
}

TEST(GltfImport, NormalsWithoutLengthAreDroppedWithAWarning) {
  const TemporaryFolder folder;
  // All three normals are the zero vector: the positions' view starts with one, and stride 0
  // repeats nothing, so a second buffer of zeros carries them.
  std::string json =
      replaced(test::triangle_json(), R"({"POSITION":0})", R"({"POSITION":0,"NORMAL":2})");
  json = replaced(
      json, R"("count":3,"type":"SCALAR"}])",
      R"("count":3,"type":"SCALAR"},{"bufferView":2,"componentType":5126,"count":3,"type":"VEC3"}])");
  json = replaced(json, R"("byteOffset":36,"byteLength":6}])",
                  R"("byteOffset":36,"byteLength":6},{"buffer":1,"byteLength":36}])");
  json = replaced(json, R"("byteLength":44}])",
                  R"("byteLength":44},{"uri":"zero.bin","byteLength":36}])");
  folder.write("zero.bin", std::string(36, '\0'));
  const auto scene = load_triangle(folder, json);
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_TRUE((*scene)->meshes[0].normals.empty());
  ASSERT_EQ((*scene)->warnings.size(), 1U);
  EXPECT_NE((*scene)->warnings[0].find("normals"), std::string::npos);
}

TEST(GltfImport, StripsAndFansBecomeTriangles) {
  // Three corners make one triangle in either mode, with the winding of the list (a fan starts from
  // its second corner).
  const TemporaryFolder folder;
  for (const auto& [mode, expected] :
       {std::pair{"5", UVec3(0, 1, 2)}, std::pair{"6", UVec3(1, 2, 0)}}) {
    const auto scene =
        load_triangle(folder, replaced(test::triangle_json(), R"("indices":1)",
                                       std::string(R"("indices":1,"mode":)") + mode));
    ASSERT_TRUE(scene) << scene.error().message();
    EXPECT_EQ((*scene)->meshes[0].triangles, std::vector<UVec3>{expected});
  }
}

TEST(GltfImport, UnknownOptionalExtensionsAreNamedInAWarning) {
  const TemporaryFolder folder;
  const auto scene =
      load_triangle(folder, replaced(test::triangle_json(), R"("scene":0,)",
                                     R"("scene":0,"extensionsUsed":["EXT_something"],)"));
  ASSERT_TRUE(scene) << scene.error().message();
  ASSERT_EQ((*scene)->warnings.size(), 1U);
  EXPECT_NE((*scene)->warnings[0].find("EXT_something"), std::string::npos);
}

TEST(GltfImport, APngTextureIsDecodedOnceAndReferredTo) {
  const TemporaryFolder folder;
  image::Plane<Rgb8> picture(4, 2, Rgb8{10, 20, 30});
  ASSERT_TRUE(image::write_png(folder.path() + "/paint it.png", picture));
  std::string json = replaced(
      test::triangle_json(), R"({"name":"paint"})",
      R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{)"
      R"("KHR_texture_transform":{"offset":[0.5,0.25],"rotation":1.5,"scale":[2,3]}}}},)"
      R"("emissiveTexture":{"index":1},"extensions":{"KHR_materials_specular":{"specularTexture":)"
      R"({"index":0,"extensions":{"KHR_texture_transform":{"offset":[0.5,0.125]}}},)"
      R"("specularColorTexture":{"index":1}}}}],)"
      R"("textures":[{"source":0,"sampler":0},{"source":0}],"samplers":[{"wrapS":33071,"wrapT":33648}],)"
      R"("images":[{"uri":"paint%20it.png"})");
  const auto scene = load_triangle(folder, json);
  ASSERT_TRUE(scene) << scene.error().message();
  ASSERT_EQ((*scene)->images.size(), 1U);
  EXPECT_EQ((*scene)->images[0].pixels.width(), 4);
  EXPECT_EQ((*scene)->images[0].pixels(3, 1).g, 20);
  const TextureRef& reference = (*scene)->materials[0].base_color_texture.value();
  EXPECT_EQ(reference.space, ColorSpace::Srgb);
  EXPECT_EQ(reference.wrap_u, Wrap::Clamp);
  EXPECT_EQ(reference.wrap_v, Wrap::Mirror);
  EXPECT_EQ(reference.uv_offset, Vec2(0.5F, 0.25F));
  EXPECT_EQ(reference.uv_scale, Vec2(2.0F, 3.0F));
  EXPECT_EQ(reference.uv_rotation_rad, 1.5F);
  EXPECT_EQ((*scene)->materials[0].emission_texture.value().image, 0U);
  const TextureRef& specular = (*scene)->materials[0].specular_texture.value();
  EXPECT_EQ(specular.space, ColorSpace::Linear);
  EXPECT_EQ(specular.wrap_u, Wrap::Clamp);
  EXPECT_EQ(specular.uv_offset, Vec2(0.5F, 0.125F));
  EXPECT_EQ((*scene)->materials[0].specular_color_texture.value().space, ColorSpace::Srgb);
  EXPECT_TRUE((*scene)->warnings.empty()) << (*scene)->warnings.front();
}

TEST(GltfImport, AJpegTextureIsDecodedWhateverItsNameAndACutOneIsRefused) {
  const TemporaryFolder folder;
  const image::Plane<Rgb8> picture(16, 8, Rgb8{200, 100, 50});
  const auto jpeg = codec::encode_color(picture, picture.rect(), {.jpeg_quality = 95});
  ASSERT_TRUE(jpeg);
  const std::string bytes(reinterpret_cast<const char*>(jpeg->data()), jpeg->size());
  const std::string json = replaced(test::triangle_json(), R"({"name":"paint"})",
                                    R"({"emissiveTexture":{"index":0}}],"textures":[{"source":0}],)"
                                    R"("images":[{"uri":"a.png"})");
  folder.write("a.png", bytes);
  const auto scene = load_triangle(folder, json);
  ASSERT_TRUE(scene) << scene.error().message();
  ASSERT_EQ((*scene)->images[0].pixels.width(), 16);
  EXPECT_NEAR((*scene)->images[0].pixels(5, 5).r, 200, 3);
  folder.write("a.png", bytes.substr(0, bytes.size() / 2));
  const auto cut = load_triangle(folder, json);
  ASSERT_FALSE(cut);
  EXPECT_NE(cut.error().message().find("a.png"), std::string::npos) << cut.error().message();
}

}  // namespace
}  // namespace macula::scene
