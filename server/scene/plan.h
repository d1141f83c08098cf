// ScenePlan: what a scene requires, and therefore which kernel suits it and which passes run. Pure
// and visible: the choice is a table with one row a rule, and every pass is named as used or left
// out, with the reason (macula-server --explain).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/scene/scene.h"

namespace macula::scene {

/// What decisions are made from; counted once.
struct SceneFacts {
  std::size_t triangles = 0;           ///< over instances
  std::size_t emissive_triangles = 0;  ///< over instances
  std::size_t lights = 0;              ///< point, spot and directional
  std::size_t textured_materials = 0;
  std::size_t masked_materials = 0;  ///< alpha tested
  std::size_t glossy_materials = 0;  ///< with a specular lobe worth evaluating
  bool has_ambient = false;
  bool is_sdf = false;  ///< described by distances, not triangles
};
SceneFacts facts_of(const Scene& scene);

enum class IndirectLight { NotWanted, Wanted };

struct KernelChoice {
  std::string_view kernel;
  std::string reason;  ///< also names a kernel that would suit better but is not registered
};
/// The first row of the table that fits and whose kernel is registered; `registered` is not empty.
KernelChoice choose_kernel(const SceneFacts& facts, IndirectLight indirect,
                           std::span<const std::string_view> registered);

struct Pass {
  std::string_view name;
  bool used = false;
  std::string reason;
};
/// Every structure and pass this program knows, in the order of a frame.
std::vector<Pass> plan_passes(const SceneFacts& facts, int ambient_samples);

}  // namespace macula::scene
