#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "server/scene/built_in/scenes.h"
#include "server/scene/built_in/shapes.h"
#include "server/scene/built_in/textures.h"
#include "server/scene/load.h"

namespace macula::scene {
namespace {

/// Made once for all tests of this program: the atrium takes about a second.
const Scene& scene_of(const BuiltIn& entry) {
  static std::map<std::string_view, Scene> made;
  const auto found = made.find(entry.name);
  return found != made.end() ? found->second
                             : made.emplace(entry.name, entry.make(1)).first->second;
}

const Scene& atrium() {
  for (const BuiltIn& entry : built_in_scenes()) {
    if (entry.name == "atrium") return scene_of(entry);
  }
  ADD_FAILURE() << "there is no atrium";
  return scene_of(built_in_scenes().front());
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

class EachBuiltIn : public testing::TestWithParam<BuiltIn> {};
INSTANTIATE_TEST_SUITE_P(Scene, EachBuiltIn,
                         testing::ValuesIn(built_in_scenes().begin(), built_in_scenes().end()),
                         [](const auto& entry) { return std::string(entry.param.name); });

TEST_P(EachBuiltIn, HasIndicesInRangeFiniteVerticesAndUnitNormals) {
  const Scene& scene = scene_of(GetParam());
  for (const Instance& instance : scene.instances) {
    ASSERT_LT(instance.mesh, scene.meshes.size());
    ASSERT_GT(glm::determinant(DMat3(instance.parent_from_object)), 0.0);
  }
  for (const Mesh& mesh : scene.meshes) {
    ASSERT_LT(mesh.material, scene.materials.size()) << mesh.name;
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size()) << mesh.name;
    ASSERT_EQ(mesh.texcoords.size(), mesh.positions.size()) << mesh.name;
    for (const Vec3& position : mesh.positions) ASSERT_TRUE(math::is_finite(position)) << mesh.name;
    for (const Vec3& normal : mesh.normals)
      ASSERT_NEAR(glm::length(normal), 1.0F, 1e-5F) << mesh.name;
    for (const UVec3& t : mesh.triangles) {
      ASSERT_LT(std::max({t.x, t.y, t.z}), mesh.positions.size()) << mesh.name;
    }
  }
  for (const Material& material : scene.materials) {
    if (material.base_color_texture) {
      ASSERT_LT(material.base_color_texture->image, scene.images.size());
    }
  }
}

TEST_P(EachBuiltIn, HasNormalsOnTheSideOfItsTriangles) {
  const Scene& scene = scene_of(GetParam());
  for (const Mesh& mesh : scene.meshes) {
    std::size_t against = 0;
    for (const UVec3& t : mesh.triangles) {
      const Vec3 face = cross(mesh.positions[t.y] - mesh.positions[t.x],
                              mesh.positions[t.z] - mesh.positions[t.x]);
      against +=
          dot(face, mesh.normals[t.x] + mesh.normals[t.y] + mesh.normals[t.z]) < 0.0F ? 1 : 0;
    }
    EXPECT_EQ(against, 0U) << mesh.name;
  }
}

TEST_P(EachBuiltIn, HasTheSameBytesForTheSameSeed) {
  const Scene& first = scene_of(GetParam());
  const Scene second = GetParam().make(1);
  ASSERT_EQ(first.meshes.size(), second.meshes.size());
  ASSERT_EQ(first.images.size(), second.images.size());
  for (std::size_t i = 0; i < first.meshes.size(); ++i) {
    EXPECT_TRUE(same_bytes(first.meshes[i].positions, second.meshes[i].positions))
        << first.meshes[i].name;
    EXPECT_TRUE(same_bytes(first.meshes[i].triangles, second.meshes[i].triangles))
        << first.meshes[i].name;
  }
  for (std::size_t i = 0; i < first.images.size(); ++i) {
    const auto &a = first.images[i].pixels, &b = second.images[i].pixels;
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(image::Rgba8)), 0)
        << first.images[i].name;
  }
}

TEST_P(EachBuiltIn, IsLitAndHasAPlaceToStandAndACamera) {
  const Scene& scene = scene_of(GetParam());
  EXPECT_TRUE(!scene.lights.empty() || scene.emissive_triangle_count() > 0);
  EXPECT_TRUE(math::is_valid(scene.settings.scene_from_stage));
  EXPECT_FALSE(scene.cameras.empty());
  EXPECT_TRUE(scene.settings.guesses.empty());
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

TEST(Atrium, IsAsRichAsPromised) {
  const Scene& scene = atrium();
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
}

/// Share of a mesh's triangles that lie in one plane with a neighbour: they share an edge (by
/// position) and their normals differ by less than half a degree.
std::size_t coplanar_triangles(const Mesh& mesh) {
  using Key = std::tuple<float, float, float>;
  const auto key = [&mesh](Index i) {
    return Key{mesh.positions[i].x, mesh.positions[i].y, mesh.positions[i].z};
  };
  const auto normal = [&mesh](const UVec3& t) {
    return normalize(cross(DVec3(mesh.positions[t.y] - mesh.positions[t.x]),
                           DVec3(mesh.positions[t.z] - mesh.positions[t.x])));
  };
  std::map<Key, Index> welded;
  for (Index i = 0; i < mesh.positions.size(); ++i) welded.emplace(key(i), i);
  std::map<std::pair<Index, Index>, std::vector<std::size_t>> by_edge;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      const Index a = welded[key(mesh.triangles[i][corner])],
                  b = welded[key(mesh.triangles[i][(corner + 1) % 3])];
      by_edge[std::minmax(a, b)].push_back(i);
    }
  }
  const double limit = std::cos(0.5 * std::numbers::pi / 180.0);
  std::vector<bool> coplanar(mesh.triangles.size());
  for (const auto& [edge, sharing] : by_edge) {
    if (sharing.size() != 2) continue;
    if (dot(normal(mesh.triangles[sharing[0]]), normal(mesh.triangles[sharing[1]])) < limit)
      continue;
    coplanar[sharing[0]] = coplanar[sharing[1]] = true;
  }
  return static_cast<std::size_t>(std::count(coplanar.begin(), coplanar.end(), true));
}

TEST(Atrium, HasAtMostAFifthOfItsTrianglesCoplanarWithANeighbour) {
  const Scene& scene = atrium();
  std::vector<std::size_t> coplanar;
  for (const Mesh& mesh : scene.meshes) coplanar.push_back(coplanar_triangles(mesh));
  double sum = 0.0;
  for (const Instance& instance : scene.instances)
    sum += static_cast<double>(coplanar[instance.mesh]);
  const double share = sum / static_cast<double>(scene.triangle_count());
  RecordProperty("share", std::to_string(share));
  EXPECT_LE(share, 0.20);
}

TEST(Shapes, ABoxIsAllCoplanarAndASphereIsNot) {
  // The counter's own check: 12 triangles in 6 planes, and none on a curved surface.
  EXPECT_EQ(coplanar_triangles(built_in::box("box", Vec3{1.0F})), 12U);
  EXPECT_EQ(coplanar_triangles(built_in::sphere("ball", 1.0F, 24, 12)), 0U);
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
