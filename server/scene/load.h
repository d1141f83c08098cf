// Scenes by name or by file: the one door the programs use.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/scene/scene.h"
#include "shared/base/result.h"

namespace macula::scene {

/// Over instances, except `unique_triangles`: what lies in memory.
struct SceneCounts {
  std::size_t triangles = 0, unique_triangles = 0, emissive_triangles = 0, lights = 0;
  friend bool operator==(const SceneCounts&, const SceneCounts&) = default;
};
SceneCounts counts_of(const Scene& scene);

struct BuiltIn {
  std::string_view name;
  std::string_view summary;
  Scene (*make)(std::uint64_t seed);
  SceneCounts counts;  ///< of seed 1, stated so that a list makes no triangles; a test holds them
};
/// The visible table of scenes made of triangles; those of distance fields are
/// sdf::built_in_fields().
std::span<const BuiltIn> built_in_scenes();

struct SceneName {
  std::string_view name, summary;
};
/// Every built-in scene of either kind.
std::vector<SceneName> scene_names();

/// A built-in name, or a path to .gltf, .glb or one of the formats of assimp/import.h, with its
/// optional side file NAME.macula.toml, or to a distance field, .sdf.json.
/// An unknown name answers with the list of names; a bad file with its path, place and remedy.
Result<std::shared_ptr<const Scene>> load_scene(const std::string& name_or_path);

/// What --list-scenes prints: every built-in scene with its stated counts; generates none.
std::string describe_built_in_scenes();

}  // namespace macula::scene
