#include "server/scene/load.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iomanip>
#include <sstream>

#include "server/scene/animation.h"
#include "server/scene/assimp/import.h"
#include "server/scene/built_in/scenes.h"
#include "server/scene/environment.h"
#include "server/scene/field_scene.h"
#include "server/scene/gltf/import.h"
#include "server/scene/settle.h"
#include "server/scene/side_file.h"
#include "server/sdf/read.h"
#include "shared/base/text.h"

namespace macula::scene {
namespace {

constexpr std::uint64_t kSeed = 1;

constexpr std::array kBuiltIn{
    BuiltIn{"atrium",
            "a court with vaulted arcades, curtains, plants and lanterns, under the sky",
            built_in::atrium,
            {965'974, 189'678, 88, 7}},
    BuiltIn{"city",
            "streets between 96 houses, each built for itself, seen from a crossing",
            built_in::city_of_houses,
            {9'741'300, 6'388'744, 0, 1}},
    BuiltIn{"city-instanced",
            "the same streets with copies of twelve houses",
            built_in::city_instanced,
            {10'467'596, 1'003'862, 0, 1}},
    BuiltIn{"cornell",
            "the Cornell box at room scale, one area light, Lambertian",
            built_in::cornell,
            {32, 32, 2, 0}},
    BuiltIn{"cornell-lights",
            "the Cornell box lit by glowing knots, burrs and beads",
            built_in::cornell_lights,
            {109'730, 109'730, 109'700, 0}},
    BuiltIn{"moving",
            "a room of turning rings, a sliding crate, a waving banner and moving lamps",
            built_in::moving,
            {16'532, 15'728, 48, 1}},
    BuiltIn{"nave",
            "a cathedral's nave: barrel vault, arcades, stained glass, sun from above",
            built_in::nave,
            {1'396'786, 177'250, 5'876, 5}},
    BuiltIn{"posts",
            "textured room with objects at 0.7 to 4 m and thin posts, for reprojection",
            built_in::posts,
            {10'256, 10'256, 0, 1}},
    BuiltIn{"room",
            "a living room in the evening: 30,000 triangles shine on a shag rug and a laid table",
            built_in::room,
            {5'270'111, 1'478'127, 33'751, 0}},
    BuiltIn{"study",
            "books, a desk and a fire at dusk, lit by 60,000 glowing triangles",
            built_in::study,
            {2'152'976, 1'217'704, 59'544, 0}},
    BuiltIn{"tunnel-geometry",
            "a bent tunnel with raised and rough panels: edges from geometry",
            built_in::tunnel_geometry,
            {434'924, 426'932, 4'400, 10}},
    BuiltIn{"tunnel-maps",
            "the same tunnel, smooth, with a checkerboard painted on it",
            built_in::tunnel_maps,
            {37'484, 29'492, 4'400, 10}},
    BuiltIn{"yard",
            "a garden party at night: 250,000 glowing triangles swing and drift",
            built_in::yard,
            {2'875'014, 1'230'200, 249'600, 1}},
};

std::string names_of_built_in_scenes() {
  std::string names;
  for (const SceneName& entry : scene_names())
    names += std::string(names.empty() ? "" : ", ").append(entry.name);
  return names;
}

/// Coordinates far beyond this lose millimeters in float.
constexpr double kFarthest = 1e7;  // m
/// What one pass over every instance may touch; small files can multiply far beyond it.
constexpr std::size_t kMostPlacedTriangles = std::size_t{1} << 28;

bool names_a_gltf_file(const std::string& path) {
  const std::string suffix = std::filesystem::path(path).extension().string();
  return suffix == ".gltf" || suffix == ".glb";
}

constexpr std::string_view kFieldSuffix = ".sdf.json";

bool names_a_field_file(const std::string& path) {
  return path.size() > kFieldSuffix.size() && path.ends_with(kFieldSuffix);
}

Result<std::shared_ptr<const Scene>> settled(Result<sdf::Field> field) {
  if (!field) return forward(field);
  const DVec3 origin = recentre(*field);
  Scene scene = scene_of(std::make_shared<const sdf::Field>(std::move(*field)));
  scene.settings.file_from_scene_m = origin;
  return std::make_shared<const Scene>(std::move(scene));
}

/// The scene in its file's units, and what the side file says of it.
struct Imported {
  Scene scene;
  SideFile side;
};

Result<Imported> import_with_side_file(const std::string& path) {
  Result<SideFile> side = read_side_file(side_file_of(path));
  if (!side) return forward(side);
  if (names_a_gltf_file(path)) {
    Result<Scene> scene = gltf::import_file(path);
    if (!scene) return forward(scene);
    return Imported{std::move(*scene), std::move(*side)};
  }
  auto imported = assimp::import_file(path);
  if (!imported) return forward(imported);
  if (!side->meters_per_unit && imported->meters_per_unit > 0.0) {
    side->meters_per_unit = imported->meters_per_unit;
    imported->scene.warnings.push_back(base::concat(
        "the file says that its unit is ", imported->meters_per_unit, " m; meters_per_unit wins"));
  }
  return Imported{std::move(imported->scene), std::move(*side)};
}

Result<std::shared_ptr<const Scene>> load_file(const std::string& path) {
  Result<Imported> imported = import_with_side_file(path);
  if (!imported) return forward(imported);
  Scene* scene = &imported->scene;
  if (scene->triangle_count() > kMostPlacedTriangles) {
    return base::bad_input(
        base::concat("its copies come to ", scene->triangle_count(), " triangles"), path,
        base::concat("at most ", kMostPlacedTriangles));
  }
  auto environment = load_environment(imported->side, path, *scene);
  if (!environment) return forward(environment);
  scene->environment = std::move(*environment);
  settle(*scene, imported->side);
  const Bounds bounds = scene->bounds();
  for (int axis = 0; axis < 3; ++axis) {
    if (!(bounds.minimum[axis] > -kFarthest && bounds.maximum[axis] < kFarthest)) {
      return base::bad_input("the scene reaches farther than 10,000 km", path,
                             "set meters_per_unit in " + side_file_of(path).filename().string());
    }
  }
  if (!moving_parts(*scene).none() && !(farthest_reach_m(*scene) < kFarthest)) {
    return base::bad_input("its motion may lead farther than 10,000 km", path,
                           "smaller translations and scales, or another meters_per_unit");
  }
  recentre(*scene);
  return std::make_shared<const Scene>(std::move(*scene));
}

}  // namespace

std::span<const BuiltIn> built_in_scenes() {
  return kBuiltIn;
}

std::vector<SceneName> scene_names() {
  std::vector<SceneName> names;
  for (const BuiltIn& entry : kBuiltIn) names.push_back({entry.name, entry.summary});
  for (const sdf::BuiltInField& entry : sdf::built_in_fields())
    names.push_back({entry.name, entry.summary});
  return names;
}

Result<std::shared_ptr<const Scene>> load_scene(const std::string& name_or_path) {
  for (const BuiltIn& entry : kBuiltIn) {
    if (entry.name == name_or_path) return std::make_shared<const Scene>(entry.make(kSeed));
  }
  for (const sdf::BuiltInField& entry : sdf::built_in_fields()) {
    if (entry.name == name_or_path)
      return settled(sdf::parse_field(entry.text, std::string(entry.name)));
  }
  if (names_a_field_file(name_or_path)) return settled(sdf::read_field(name_or_path));
  if (names_a_gltf_file(name_or_path) || assimp::reads(name_or_path))
    return load_file(name_or_path);
  return base::bad_input("no such scene", name_or_path,
                         "a file ending in .gltf, .glb, .sdf.json, " + assimp::list_of_suffixes() +
                             ", or one of " + names_of_built_in_scenes());
}

SceneCounts counts_of(const Scene& scene) {
  return {scene.triangle_count(), scene.unique_triangle_count(), scene.emissive_triangle_count(),
          scene.lights.size()};
}

std::string describe_built_in_scenes() {
  std::ostringstream text;
  for (const BuiltIn& entry : kBuiltIn) {
    const SceneCounts& counts = entry.counts;
    text << std::left << std::setw(17) << entry.name << entry.summary << '\n'
         << std::setw(17) << "" << counts.triangles << " triangles (" << counts.unique_triangles
         << " unique, " << counts.emissive_triangles << " emissive), " << counts.lights
         << " lights\n";
  }
  for (const sdf::BuiltInField& entry : sdf::built_in_fields()) {
    text << std::left << std::setw(17) << entry.name << entry.summary << '\n'
         << std::setw(17) << ""
         << "a distance field\n";
  }
  return std::move(text).str();
}

}  // namespace macula::scene
