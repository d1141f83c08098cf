#include "server/scene/plan.h"

#include <algorithm>
#include <array>

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

Pass pass(std::string_view name, std::size_t count, std::string_view what, std::string_view none) {
  return {name, count > 0, count > 0 ? base::concat(count, " ", what) : std::string(none)};
}

bool is_textured(const Material& material) {
  return material.base_color_texture || material.metallic_roughness_texture ||
         material.emission_texture;
}

/// A rough dielectric's highlight is below what a frame shows; metal and polish are not.
bool is_glossy(const Material& material) {
  return material.specular > 0.0F && (material.metallic > 0.0F || material.roughness < 1.0F);
}

}  // namespace

SceneFacts facts_of(const Scene& scene) {
  SceneFacts facts;
  facts.triangles = scene.triangle_count();
  facts.emissive_triangles = scene.emissive_triangle_count();
  facts.lights = scene.lights.size();
  for (const Material& material : scene.materials) {
    facts.textured_materials += is_textured(material) ? 1 : 0;
    facts.masked_materials += material.alpha_mode == AlphaMode::Mask ? 1 : 0;
    facts.glossy_materials += is_glossy(material) ? 1 : 0;
  }
  const Rgb& ambient = scene.settings.ambient;
  facts.has_ambient = ambient.x > 0.0F || ambient.y > 0.0F || ambient.z > 0.0F;
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

std::vector<Pass> plan_passes(const SceneFacts& facts, int ambient_samples) {
  const bool ambient = facts.has_ambient && ambient_samples > 0;
  return {
      pass("triangle BVH", facts.triangles, "triangles", "no triangles"),
      pass("alpha test", facts.masked_materials, "masked materials", "no masked material"),
      pass("texture mip maps", facts.textured_materials, "textured materials",
           "no textured material"),
      pass("specular lobe", facts.glossy_materials, "glossy materials", "no glossy material"),
      pass("point, spot and directional lights", facts.lights, "lights", "no such light"),
      pass("area-light sampling", facts.emissive_triangles, "emissive triangles",
           "no emissive triangles"),
      {"ambient occlusion", ambient,
       !facts.has_ambient ? "no ambient light"
       : ambient          ? base::concat(ambient_samples, " samples a primary sample")
                          : std::string("--ambient-samples is 0")},
      {"distance-field tracer", facts.is_sdf,
       facts.is_sdf ? "the scene is a distance field" : "no distance field"},
      {"refit per frame", false, "nothing moves"},
  };
}

}  // namespace macula::scene
