#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <set>
#include <string_view>

#include <gtest/gtest.h>

#include "server/scene/animation.h"
#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/scenes.h"
#include "server/scene/built_in/shapes.h"
#include "server/scene/built_in/textures.h"
#include "server/scene/load.h"
#include "tests/server/scene/measure.h"

namespace macula::scene {
namespace {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_indices_in_range(const Scene& scene) {
  for (const Instance& instance : scene.instances) {
    ASSERT_LT(instance.mesh, scene.meshes.size());
    ASSERT_GT(glm::determinant(DMat3(instance.parent_from_object)), 0.0);
  }
  const auto motion = check_motion(scene);
  ASSERT_TRUE(motion) << (motion ? "" : motion.error().message());
  for (const Material& material : scene.materials) {
    for (const auto& texture : {material.base_color_texture, material.emission_texture}) {
      if (texture) {
        ASSERT_LT(texture->image, scene.images.size()) << material.name;
      }
    }
  }
  for (const Mesh& mesh : scene.meshes) {
    ASSERT_LT(mesh.material, scene.materials.size()) << mesh.name;
    ASSERT_FALSE(mesh.triangles.empty()) << mesh.name;
    Index largest = 0;
    for (const UVec3& t : mesh.triangles) largest = std::max({largest, t.x, t.y, t.z});
    ASSERT_LT(largest, mesh.positions.size()) << mesh.name;
  }
}

void expect_finite_vertices_and_unit_normals(const Mesh& mesh) {
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size()) << mesh.name;
  ASSERT_EQ(mesh.texcoords.size(), mesh.positions.size()) << mesh.name;
  std::size_t infinite = 0, not_unit = 0;
  for (const Vec3& position : mesh.positions) infinite += math::is_finite(position) ? 0 : 1;
  for (const Vec3& normal : mesh.normals)
    not_unit += std::abs(dot(normal, normal) - 1.0F) < 2e-5F ? 0 : 1;
  EXPECT_EQ(infinite, 0U) << mesh.name;
  EXPECT_EQ(not_unit, 0U) << mesh.name;
}

void expect_normals_on_the_side_of_triangles(const Mesh& mesh) {
  std::size_t against = 0;
  for (const UVec3& t : mesh.triangles) {
    const Vec3 face =
        cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
    against += dot(face, mesh.normals[t.x] + mesh.normals[t.y] + mesh.normals[t.z]) < 0.0F ? 1 : 0;
  }
  EXPECT_EQ(against, 0U) << mesh.name;
}

void expect_the_same_bytes(const Scene& first, const Scene& second) {
  ASSERT_EQ(first.meshes.size(), second.meshes.size());
  ASSERT_EQ(first.images.size(), second.images.size());
  for (std::size_t i = 0; i < first.meshes.size(); ++i) {
    const Mesh &a = first.meshes[i], &b = second.meshes[i];
    EXPECT_TRUE(same_bytes(a.positions, b.positions)) << a.name;
    EXPECT_TRUE(same_bytes(a.triangles, b.triangles)) << a.name;
  }
  for (std::size_t i = 0; i < first.images.size(); ++i) {
    const auto &a = first.images[i].pixels, &b = second.images[i].pixels;
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(image::Rgba8)), 0)
        << first.images[i].name;
  }
}

class EachBuiltIn : public testing::TestWithParam<BuiltIn> {};
INSTANTIATE_TEST_SUITE_P(Scene, EachBuiltIn,
                         testing::ValuesIn(built_in_scenes().begin(), built_in_scenes().end()),
                         [](const auto& entry) {
                           std::string name(entry.param.name);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

// One test a scene: the large ones take a second each to make.
TEST_P(EachBuiltIn, IsSoundLitAsLargeAsStatedAndTheSameForTheSameSeed) {
  const Scene scene = GetParam().make(1);
  ASSERT_NO_FATAL_FAILURE(expect_indices_in_range(scene));
  for (const Mesh& mesh : scene.meshes) {
    ASSERT_NO_FATAL_FAILURE(expect_finite_vertices_and_unit_normals(mesh));
    expect_normals_on_the_side_of_triangles(mesh);
  }
  EXPECT_EQ(scene.name, GetParam().name);
  EXPECT_EQ(counts_of(scene), GetParam().counts) << describe(scene);
  EXPECT_TRUE(!scene.lights.empty() || scene.emissive_triangle_count() > 0);
  EXPECT_TRUE(math::is_valid(scene.settings.scene_from_stage));
  EXPECT_FALSE(scene.cameras.empty());
  EXPECT_TRUE(scene.settings.guesses.empty());
  expect_the_same_bytes(scene, GetParam().make(1));
}

TEST(Cornell, HasTheBoxesWallsAndLampOfTheOriginal) {
  const Scene scene = built_in::cornell(1);
  // 5 walls, 2 blocks of 5 faces, 1 lamp: 16 quadrilaterals.
  EXPECT_EQ(scene.triangle_count(), 32U);
  EXPECT_EQ(scene.emissive_triangle_count(), 2U);
  const Bounds bounds = scene.bounds();
  EXPECT_NEAR(bounds.size().x, 2.4, 1e-5);
  EXPECT_NEAR(bounds.size().y, 2.4 * 548.8 / 552.8, 1e-5);
}

TEST(Cornell, FacesInwardsEverywhere) {
  // Seen from the middle of the room, every wall shows its front; blocks and lamp are left out.
  const Scene scene = built_in::cornell(1);
  const DVec3 middle{0.0, 1.2, -1.2};
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.name.find("wall") == std::string::npos && mesh.name != "floor" &&
        mesh.name != "ceiling")
      continue;
    const UVec3 t = mesh.triangles[0];
    const DVec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    EXPECT_GT(dot(cross(b - a, c - a), middle - a), 0.0) << mesh.name;
  }
}

TEST(Posts, HasTenObjectsBetweenPointSevenAndFourMeters) {
  const Scene scene = built_in::posts(1);
  int near = 0;
  for (const Instance& instance : scene.instances) {
    const double distance =
        glm::length(DVec2(instance.parent_from_object[3].x, instance.parent_from_object[3].z));
    near += distance >= 0.7 && distance <= 4.0 ? 1 : 0;
  }
  EXPECT_GE(near, 10);
}

const BuiltIn& entry_of(std::string_view name) {
  const auto found = std::ranges::find(built_in_scenes(), name, &BuiltIn::name);
  EXPECT_NE(found, built_in_scenes().end()) << name;
  return *found;
}

// The stated counts, which the test of each scene holds to what is made.
TEST(BuiltInScenes, WithManyLightsHaveThePapersSizeWithinAFifth) {
  // Foveated stochastic lightcuts, section 4: triangles, light sources.
  struct Paper {
    const char* scene;
    double triangles, lights;
  };
  for (const Paper& paper :
       {Paper{"study", 2'110'100, 58'100}, Paper{"room", 5'103'900, 30'400},
        Paper{"cornell-lights", 110'500, 110'500}, Paper{"yard", 2'575'100, 250'600}}) {
    const SceneCounts& counts = entry_of(paper.scene).counts;
    EXPECT_NEAR(static_cast<double>(counts.triangles), paper.triangles, 0.2 * paper.triangles)
        << paper.scene;
    EXPECT_NEAR(static_cast<double>(counts.emissive_triangles), paper.lights, 0.2 * paper.lights)
        << paper.scene;
  }
}

TEST(BuiltInScenes, HoldACityOfSixMillionTrianglesAndOneOfCopies) {
  EXPECT_GE(entry_of("city").counts.unique_triangles, 6'000'000U);
  EXPECT_GE(entry_of("city-instanced").counts.triangles, 6'000'000U);
  EXPECT_LE(entry_of("city-instanced").counts.unique_triangles, 1'200'000U);
}

TEST(Tunnels, AreTheSameTunnelTwice) {
  // Raised panels stand up to 20 cm into it and gravel lies 8 cm deep; outside they agree.
  const Bounds shaped = built_in::tunnel_geometry(1).bounds();
  const Bounds painted = built_in::tunnel_maps(1).bounds();
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(shaped.minimum[axis], painted.minimum[axis], 0.1) << axis;
    EXPECT_NEAR(shaped.maximum[axis], painted.maximum[axis], 0.1) << axis;
  }
}

TEST(Yard, HasNoLightThatStandsStill) {
  const Scene scene = built_in::yard(1);
  const MovingParts moving = moving_parts(scene);
  for (Index i = 0; i < scene.instances.size(); ++i) {
    if (!scene.materials[scene.meshes[scene.instances[i].mesh].material].emits()) continue;
    EXPECT_TRUE(std::ranges::binary_search(moving.instances, i)) << i;
  }
  // Closed loops: after every period a joint is where it was.
  for (const Joint& joint : scene.joints) {
    ASSERT_GT(joint.period.count(), 0);
    const auto& places = joint.translations.values;
    if (!places.empty()) {
      EXPECT_LT(glm::distance(places.front(), places.back()), 1e-9);
    }
    EXPECT_LT(
        1.0 - std::abs(glm::dot(joint.rotations.values.front(), joint.rotations.values.back())),
        1e-12);
  }
}

double coplanar_share(const Scene& scene) {
  std::vector<std::size_t> coplanar;
  for (const Mesh& mesh : scene.meshes) coplanar.push_back(measure::coplanar_triangles(mesh));
  double sum = 0.0;
  for (const Instance& instance : scene.instances)
    sum += static_cast<double>(coplanar[instance.mesh]);
  return sum / static_cast<double>(scene.triangle_count());
}

TEST(Atrium, IsAsRichAsPromised) {
  const Scene scene = built_in::atrium(1);
  EXPECT_GE(scene.triangle_count(), 250'000U);
  EXPECT_GE(scene.unique_triangle_count(), 150'000U);
  std::set<Index> materials;
  for (const Mesh& mesh : scene.meshes) materials.insert(mesh.material);
  EXPECT_GE(materials.size(), 20U);
  int large = 0;
  for (const Image& image : scene.images)
    large += image.pixels.width() >= 1024 && image.pixels.height() >= 1024 ? 1 : 0;
  EXPECT_GE(large, 10);
  EXPECT_TRUE(std::any_of(scene.materials.begin(), scene.materials.end(),
                          [](const Material& m) { return m.alpha_mode == AlphaMode::Mask; }));
  EXPECT_LE(coplanar_share(scene), 0.20);
  for (const Camera& camera : scene.cameras) {
    const double layers = measure::mean_depth_complexity(scene, camera);
    RecordProperty("depth_complexity_" + camera.name, std::to_string(layers));
    EXPECT_GE(layers, 3.0) << camera.name;
  }
}

TEST(Measure, CountsFrontsAndBacksAlongALineOfSight) {
  // Two boxes behind one another that both fill the picture: two faces each.
  const Camera camera{"c", math::look_at({0.1, 0, 3}, {0.1, 0, 0}, {0, 1, 0}), Degrees{8.0}};
  built_in::SceneBuilder builder("boxes");
  const Index grey = builder.add(built_in::lambert("grey", Rgb{0.5F}));
  const Index box = builder.add(built_in::box("box", Vec3{2.0F}), grey);
  builder.place(box);
  builder.place(box, built_in::translation({0, 0, -3}));
  const Scene scene = std::move(builder).finish();
  // Centres exactly on a face's diagonal belong to neither triangle: one in a hundred at most.
  EXPECT_NEAR(measure::mean_depth_complexity(scene, camera), 4.0, 0.04);
}

TEST(Measure, CutsWhatReachesBehindTheEye) {
  // A floor from far behind to far ahead covers the lower half of a level view.
  const Camera camera{"c", math::look_at({0, 1, 0}, {0, 1, -1}, {0, 1, 0}), Degrees{60.0}};
  built_in::SceneBuilder builder("floor");
  const Index grey = builder.add(built_in::lambert("grey", Rgb{0.5F}));
  builder.place(built_in::parallelogram("floor", {-1e4F, 0, 1e4F}, {2e4F, 0, 0}, {0, 0, -2e4F}),
                grey);
  const Scene scene = std::move(builder).finish();
  EXPECT_NEAR(measure::mean_depth_complexity(scene, camera), 0.5, 0.02);
}

TEST(Shapes, ABoxIsAllCoplanarAndASphereIsNot) {
  // The counter's own check: 12 triangles in 6 planes, and none on a curved surface.
  EXPECT_EQ(measure::coplanar_triangles(built_in::box("box", Vec3{1.0F})), 12U);
  EXPECT_EQ(measure::coplanar_triangles(built_in::sphere("ball", 1.0F, 24, 12)), 0U);
}

TEST(Shapes, ClosedSurfacesEncloseTheirVolume) {
  // Divergence theorem: the volume is the sum of signed tetrahedra, and positive when fronts point
  // out.
  const auto volume = [](const Mesh& mesh) {
    double sum = 0.0;
    for (const UVec3& t : mesh.triangles) {
      sum += dot(DVec3(mesh.positions[t.x]),
                 cross(DVec3(mesh.positions[t.y]), DVec3(mesh.positions[t.z]))) /
             6.0;
    }
    return sum;
  };
  EXPECT_NEAR(volume(built_in::box("", Vec3{1.0F, 2.0F, 3.0F})), 6.0, 1e-5);
  EXPECT_NEAR(volume(built_in::sphere("", 1.0F, 128, 64)), 4.0 / 3.0 * std::numbers::pi, 0.01);
  // 2 pi^2 R r^2
  EXPECT_NEAR(volume(built_in::torus("", 1.0F, 0.25F, 128, 64)),
              2.0 * std::pow(std::numbers::pi, 2) / 16.0, 0.005);
}

TEST(Textures, NoiseHasNoSeamAndIsBounded) {
  const built_in::Field field = built_in::noise(128, {.cells = 4, .octaves = 4}, 7);
  float largest_inside = 0.0F, largest_across = 0.0F;
  for (int y = 0; y < 128; ++y) {
    for (int x = 1; x < 128; ++x) {
      largest_inside = std::max(largest_inside, std::abs(field(x, y) - field(x - 1, y)));
      ASSERT_LE(std::abs(field(x, y)), 1.5F);
    }
    largest_across = std::max(largest_across, std::abs(field(0, y) - field(127, y)));
  }
  EXPECT_LE(largest_across, largest_inside);
}

}  // namespace
}  // namespace macula::scene
