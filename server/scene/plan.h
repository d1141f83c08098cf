// ScenePlan: what a scene requires, and therefore which kernel suits it, which structures are built
// and which passes run. Pure and visible: each choice is a table with one row a rule. Kernels and
// structures ask the plan, so what `macula-server --explain` prints as left out is neither built
// nor run. Immutable values.
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
  std::size_t textured_materials = 0;  ///< materials count where an instance shows them
  std::size_t masked_materials = 0;    ///< alpha tested: Mask or Blend
  std::size_t glossy_materials = 0;    ///< with a specular lobe, however weak
  bool has_ambient = false;
  bool has_environment = false;      ///< one that is not black
  bool is_sdf = false;               ///< described by distances, not triangles
  std::size_t moving_instances = 0;  ///< carried by joints, or of meshes that change shape
  std::size_t changing_meshes = 0;   ///< whose vertices move
  std::size_t moving_lights = 0;     ///< punctual lights and emissive triangles that are carried
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

/// Every structure and pass this program knows, in the order of a frame.
enum class Step {
  TriangleBvh,
  AlphaTest,
  Textures,
  SpecularLobe,
  PunctualLights,
  AreaLights,
  LightTree,
  VirtualLights,
  Ambient,
  Environment,
  DistanceField,
  TopLevel,
  Refit,
  MovingLights,
};

/// Used: wherever the scene needs it. Forced: everywhere it can be built or run, though nothing
/// needs it; a picture must not change by that (tests hold it).
enum class StepUse { LeftOut, Used, Forced };

struct PlannedStep {
  Step step;
  std::string_view name;
  StepUse use = StepUse::LeftOut;
  std::string reason;
};

/// What is asked for beside what the scene requires.
struct Wishes {
  int ambient_samples = 4;      ///< per primary sample; 0: no ambient term
  int environment_samples = 4;  ///< per primary sample
  /// Which kernel will run; empty: any may.
  std::string_view kernel = {};
};

class ScenePlan {
 public:
  explicit ScenePlan(const SceneFacts& facts, const Wishes& wishes = {});

  StepUse use(Step step) const;
  /// Used or Forced.
  bool has(Step step) const { return use(step) != StepUse::LeftOut; }
  /// Every step once, in the order of a frame.
  std::span<const PlannedStep> steps() const { return steps_; }

  /// The same plan but for one step: how tests show that a plan leaves out neither too much nor too
  /// little.
  ScenePlan forcing(Step step) const;
  ScenePlan without(Step step) const;

 private:
  ScenePlan with(Step step, StepUse use, std::string reason) const;
  std::vector<PlannedStep> steps_;
};

}  // namespace macula::scene
