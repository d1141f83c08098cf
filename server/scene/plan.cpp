#include "server/scene/plan.h"

#include <algorithm>
#include <array>

#include "server/scene/animation.h"
#include "shared/base/check.h"
#include "shared/base/text.h"

namespace macula::scene {
namespace {

constexpr std::size_t kManyLights = 64;

struct Rule {
  std::string_view kernel;
  bool (*fits)(const SceneFacts&, IndirectLight);
  std::string (*reason)(const SceneFacts&);
};

std::string light_count(const SceneFacts& facts) {
  return base::concat(facts.lights + facts.emissive_triangles, " lights and emissive triangles");
}

constexpr std::array kRules{
    Rule{"sphere", [](const SceneFacts& facts, IndirectLight) { return facts.is_sdf; },
         [](const SceneFacts&) -> std::string { return "the scene is a distance field"; }},
    Rule{"lightcuts",
         [](const SceneFacts& facts, IndirectLight) {
           return facts.lights + facts.emissive_triangles > kManyLights;
         },
         [](const SceneFacts& facts) {
           return base::concat(light_count(facts), " are more than ", kManyLights);
         }},
    Rule{
        "culling",
        [](const SceneFacts&, IndirectLight indirect) { return indirect == IndirectLight::Wanted; },
        [](const SceneFacts&) -> std::string { return "indirect light is asked for"; }},
    Rule{"ray", [](const SceneFacts&, IndirectLight) { return true; },
         [](const SceneFacts& facts) {
           return base::concat(facts.triangles, " triangles under ", light_count(facts));
         }},
};

bool is_registered(std::string_view kernel, std::span<const std::string_view> registered) {
  return std::find(registered.begin(), registered.end(), kernel) != registered.end();
}

bool is_textured(const Material& material) {
  return material.base_color_texture || material.metallic_roughness_texture ||
         material.emission_texture || material.specular_texture || material.specular_color_texture;
}

/// Whether alpha can take anything of its surface away.
bool may_be_absent(const Material& material) {
  if (material.alpha_mode == AlphaMode::Opaque) return false;
  const float least = material.alpha_mode == AlphaMode::Mask ? material.alpha_cutoff : 1.0F;
  return material.base_color_texture.has_value() || material.alpha < least;
}

/// Reflects anything at normal or at grazing incidence (shading::MaterialTable): metal by its base
/// colour, a dielectric unless KHR_materials_specular turns that off.
bool is_glossy(const Material& material) {
  return material.specular > 0.0F || material.metallic > 0.0F;
}

/// By material: whether an instance shows it.
std::vector<bool> materials_shown(const Scene& scene) {
  std::vector<bool> shown(scene.materials.size(), scene.field != nullptr);
  for (const Instance& instance : scene.instances) {
    shown[scene.meshes[instance.mesh].material] = true;
  }
  return shown;
}

bool any_positive(const Rgb& c) {
  return c.x > 0.0F || c.y > 0.0F || c.z > 0.0F;
}

// ---- the steps of a frame ----

struct Verdict {
  bool needed;
  std::string reason;
};
Verdict if_any(std::size_t count, std::string_view what, std::string_view none) {
  return {count > 0, count > 0 ? base::concat(count, " ", what) : std::string(none)};
}

Verdict ambient(const SceneFacts& facts, const Wishes& wishes) {
  if (!facts.has_ambient) return {false, "no ambient light"};
  if (wishes.ambient_samples == 0) return {false, "0 ambient samples are asked for"};
  return {true, base::concat(wishes.ambient_samples, " samples a primary sample")};
}

Verdict environment(const SceneFacts& facts, const Wishes& wishes) {
  if (!facts.has_environment) return {false, "no environment"};
  return {true, base::concat(wishes.environment_samples, " samples a primary sample")};
}

Verdict light_tree(const SceneFacts& facts, const Wishes& wishes) {
  if (facts.lights + facts.emissive_triangles == 0) return {false, "no lights"};
  if (!wishes.kernel.empty() && wishes.kernel != "lightcuts") {
    return {false, base::concat("kernel '", wishes.kernel, "' does not ask it")};
  }
  return {true, light_count(facts)};
}

Verdict virtual_lights(const SceneFacts& facts, const Wishes& wishes) {
  if (facts.lights + facts.emissive_triangles == 0) return {false, "no lights"};
  if (!wishes.kernel.empty() && wishes.kernel != "culling") {
    return {false, base::concat("kernel '", wishes.kernel, "' makes none")};
  }
  return {true, "light that surfaces have reflected once"};
}

struct StepRule {
  Step step;
  std::string_view name;
  Verdict (*decide)(const SceneFacts&, const Wishes&);
};

/// In the order of a frame, which is the order of Step.
constexpr std::array kSteps{
    StepRule{Step::TriangleBvh, "triangle BVH",
             [](const SceneFacts& facts, const Wishes&) {
               return if_any(facts.triangles, "triangles", "no triangles");
             }},
    StepRule{Step::AlphaTest, "alpha test",
             [](const SceneFacts& facts, const Wishes&) {
               return if_any(facts.masked_materials, "masked or blended materials",
                             "every surface is opaque");
             }},
    StepRule{Step::Textures, "texture mip maps",
             [](const SceneFacts& facts, const Wishes&) {
               return if_any(facts.textured_materials, "textured materials",
                             "no textured material");
             }},
    StepRule{Step::SpecularLobe, "specular lobe",
             [](const SceneFacts& facts, const Wishes&) {
               return if_any(facts.glossy_materials, "glossy materials", "no glossy material");
             }},
    StepRule{Step::PunctualLights, "point, spot and directional lights",
             [](const SceneFacts& facts, const Wishes&) {
               return if_any(facts.lights, "lights", "no such light");
             }},
    StepRule{Step::AreaLights, "area-light table and sampling",
             [](const SceneFacts& facts, const Wishes&) {
               return if_any(facts.emissive_triangles, "emissive triangles",
                             "no emissive triangles");
             }},
    StepRule{Step::LightTree, "light tree", light_tree},
    StepRule{Step::VirtualLights, "virtual point lights", virtual_lights},
    StepRule{Step::Ambient, "ambient occlusion", ambient},
    StepRule{Step::Environment, "environment table and sampling", environment},
    StepRule{Step::DistanceField, "distance-field tracer",
             [](const SceneFacts& facts, const Wishes&) {
               return Verdict{facts.is_sdf,
                              facts.is_sdf ? "the scene is a distance field" : "no distance field"};
             }},
    StepRule{Step::TopLevel, "top level per frame",
             [](const SceneFacts& facts, const Wishes&) {
               return if_any(facts.moving_instances, "moving instances", "no instance moves");
             }},
    StepRule{Step::Refit, "refit per frame",
             [](const SceneFacts& facts, const Wishes&) {
               return if_any(facts.changing_meshes, "meshes change shape", "no mesh changes shape");
             }},
    StepRule{Step::MovingLights, "moving lights",
             [](const SceneFacts& facts, const Wishes&) {
               return if_any(facts.moving_lights, "lights and emissive triangles move",
                             "no light moves");
             }},
};

/// ScenePlan finds a step at its own index.
constexpr bool in_order() {
  for (std::size_t i = 0; i < kSteps.size(); ++i) {
    if (static_cast<std::size_t>(kSteps[i].step) != i) return false;
  }
  return true;
}
static_assert(in_order(), "a row for every step, in the order of the enumeration");

void count_motion(const Scene& scene, SceneFacts& facts) {
  const MovingParts moving = moving_parts(scene);
  facts.moving_instances = moving.instances.size();
  facts.changing_meshes = moving.meshes.size();
  facts.moving_lights = moving.lights.size();
  for (const Index i : moving.instances) {
    const Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    if (scene.materials[mesh.material].emits()) facts.moving_lights += mesh.triangles.size();
  }
}

}  // namespace

SceneFacts facts_of(const Scene& scene) {
  SceneFacts facts;
  facts.triangles = scene.triangle_count();
  facts.emissive_triangles = scene.emissive_triangle_count();
  facts.lights = scene.lights.size();
  facts.is_sdf = scene.field != nullptr;
  const std::vector<bool> shown = materials_shown(scene);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (!shown[i]) continue;
    const Material& material = scene.materials[i];
    facts.textured_materials += is_textured(material) ? 1 : 0;
    facts.masked_materials += may_be_absent(material) ? 1 : 0;
    facts.glossy_materials += is_glossy(material) ? 1 : 0;
  }
  facts.has_ambient = any_positive(scene.settings.ambient);
  facts.has_environment = scene.environment && any_positive(scene.environment->mean());
  count_motion(scene, facts);
  return facts;
}

KernelChoice choose_kernel(const SceneFacts& facts, IndirectLight indirect,
                           std::span<const std::string_view> registered) {
  MACULA_CHECK(!registered.empty(), "a server has at least one kernel");
  std::string wished;
  for (const Rule& rule : kRules) {
    if (!rule.fits(facts, indirect)) continue;
    if (is_registered(rule.kernel, registered)) return {rule.kernel, wished + rule.reason(facts)};
    wished += base::concat("'", rule.kernel, "' would suit (", rule.reason(facts),
                           ") but is not part of this build; ");
  }
  return {registered.front(), wished + "the only kernel there is"};
}

ScenePlan::ScenePlan(const SceneFacts& facts, const Wishes& wishes) {
  for (const StepRule& rule : kSteps) {
    Verdict verdict = rule.decide(facts, wishes);
    steps_.push_back({rule.step, rule.name, verdict.needed ? StepUse::Used : StepUse::LeftOut,
                      std::move(verdict.reason)});
  }
}

StepUse ScenePlan::use(Step step) const {
  return steps_[static_cast<std::size_t>(step)].use;
}

ScenePlan ScenePlan::forcing(Step step) const {
  return with(step, StepUse::Forced, "forced");
}

ScenePlan ScenePlan::without(Step step) const {
  return with(step, StepUse::LeftOut, "forbidden");
}

ScenePlan ScenePlan::with(Step step, StepUse use, std::string reason) const {
  ScenePlan changed = *this;
  PlannedStep& entry = changed.steps_[static_cast<std::size_t>(step)];
  entry.use = use;
  entry.reason = std::move(reason);
  return changed;
}

}  // namespace macula::scene
