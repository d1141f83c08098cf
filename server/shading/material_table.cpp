#include "server/shading/material_table.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "server/shading/ggx.h"
#include "shared/base/check.h"
#include "shared/base/parallel.h"

namespace macula::shading {
namespace {

/// Reflectance of a dielectric at normal incidence for index of refraction 1.5, glTF's default.
constexpr float kDielectricF0 = 0.04F;

/// Length scale of a texture transform: how footprints grow through it.
float footprint_scale(const scene::TextureRef& reference) {
  return std::sqrt(std::abs(reference.uv_scale.x * reference.uv_scale.y));
}

Bsdf with_phongs_lobe(Bsdf bsdf, float least_f0) {
  bsdf.lobe = LobeModel::Phong;
  bsdf.f0 = glm::max(bsdf.f0, Rgb{least_f0});
  bsdf.f90 = 0.0F;
  return bsdf;
}

}  // namespace

/// The images that materials look up, each once; made into textures together, on all cores.
class MaterialTable::TextureList {
 public:
  TextureList(const scene::Scene& scene, scene::StepUse use) : scene_(scene), use_(use) {
    if (use == scene::StepUse::Forced) images_.emplace_back(nullptr, scene::ColorSpace::Linear);
  }

  /// What has no image is white where textures are forced.
  std::optional<Lookup> look_up(const std::optional<scene::TextureRef>& reference) {
    constexpr std::size_t kWhite = 0;
    if (use_ == scene::StepUse::LeftOut) return std::nullopt;
    if (!reference && use_ == scene::StepUse::Forced) return Lookup{kWhite, {}};
    if (!reference) return std::nullopt;
    MACULA_CHECK(reference->image < scene_.images.size(), "import checks image indices");
    const auto [place, added] =
        known_.try_emplace({reference->image, reference->space}, images_.size());
    if (added) images_.emplace_back(&scene_.images[reference->image].pixels, reference->space);
    return Lookup{place->second, *reference};
  }
  std::vector<Texture> make() const {
    static const image::Plane<image::Rgba8> kNoPixels;
    std::vector<std::optional<Texture>> made(images_.size());
    base::for_each_index(images_.size(), [&](std::size_t i) {
      const auto& [pixels, space] = images_[i];
      made[i].emplace(pixels != nullptr ? *pixels : kNoPixels, space);
    });
    std::vector<Texture> textures;
    textures.reserve(made.size());
    for (std::optional<Texture>& texture : made) textures.push_back(std::move(*texture));
    return textures;
  }

 private:
  const scene::Scene& scene_;
  scene::StepUse use_;
  std::vector<std::pair<const image::Plane<image::Rgba8>*, scene::ColorSpace>> images_;
  std::map<std::pair<scene::Index, scene::ColorSpace>, std::size_t> known_;
};

MaterialTable::MaterialTable(const scene::Scene& scene, const MaterialOptions& options)
    : options_(options) {
  TextureList list(scene, options.textures);
  materials_.reserve(scene.materials.size());
  for (const scene::Material& material : scene.materials) {
    materials_.push_back({material, list.look_up(material.base_color_texture),
                          list.look_up(material.metallic_roughness_texture),
                          list.look_up(material.emission_texture),
                          list.look_up(material.specular_texture),
                          list.look_up(material.specular_color_texture), material.emission});
  }
  textures_ = list.make();
  for (Entry& entry : materials_) {
    if (entry.emission) entry.mean_emission *= Rgb(textures_[entry.emission->texture].mean());
    const scene::Material& material = entry.material;
    const bool blends = material.alpha_mode == scene::AlphaMode::Blend;
    if (blends && material.alpha > 0.0F) entry.mean_emission *= material.alpha;
  }
}

Vec4 MaterialTable::read(const std::optional<Lookup>& lookup, const Vec2& uv,
                         float footprint_uv) const {
  if (!lookup) return Vec4{1.0F};
  const scene::TextureRef& reference = lookup->reference;
  return textures_[lookup->texture].sample(transform_uv(reference, uv),
                                           footprint_uv * footprint_scale(reference),
                                           reference.wrap_u, reference.wrap_v);
}

Bsdf MaterialTable::bsdf(scene::Index material, const Vec2& uv, float footprint_uv,
                         MaterialModel model) const {
  const Entry& entry = materials_[material];
  const Rgb base = base_color(material, uv, footprint_uv);
  if (model == MaterialModel::Lambert) return Bsdf{base};
  const scene::Material& m = entry.material;
  if (options_.specular_lobe == scene::StepUse::LeftOut) return Bsdf{(1.0F - m.metallic) * base};
  const Vec4 texture = read(entry.metallic_roughness, uv, footprint_uv);
  return make_bsdf(
      {.base = base,
       .metallic = m.metallic * texture.z,
       .roughness = m.roughness * texture.y,
       .specular = m.specular * read(entry.specular, uv, footprint_uv).w,
       .specular_color = m.specular_color * Rgb(read(entry.specular_color, uv, footprint_uv))},
      model);
}

Bsdf MaterialTable::bsdf(scene::Index material, const Rgb& base_color, MaterialModel model) const {
  const scene::Material& m = materials_[material].material;
  if (model == MaterialModel::Lambert) return Bsdf{base_color};
  if (options_.specular_lobe == scene::StepUse::LeftOut) {
    return Bsdf{(1.0F - m.metallic) * base_color};
  }
  return make_bsdf({base_color, m.metallic, m.roughness, m.specular, m.specular_color}, model);
}

Bsdf MaterialTable::make_bsdf(const Factors& at, MaterialModel model) const {
  const Rgb dielectric = at.specular * glm::min(kDielectricF0 * at.specular_color, Rgb{1.0F});
  Bsdf bsdf;
  bsdf.albedo = (1.0F - at.metallic) * at.base;
  bsdf.f0 = (1.0F - at.metallic) * dielectric + at.metallic * at.base;
  bsdf.f90 = (1.0F - at.metallic) * at.specular + at.metallic;
  bsdf.alpha = std::clamp(at.roughness * at.roughness, kLeastAlpha, 1.0F);
  const float least = options_.specular_lobe == scene::StepUse::Forced ? kFaintestLobe : 0.0F;
  bsdf.f90 = std::max(bsdf.f90, least);
  return model == MaterialModel::Phong ? with_phongs_lobe(bsdf, least) : bsdf;
}

void MaterialTable::fetch(scene::Index material, const Vec2& uv, float footprint_uv) const {
  const auto& lookup = materials_[material].base_color;
  if (!lookup) return;
  const scene::TextureRef& reference = lookup->reference;
  textures_[lookup->texture].fetch(transform_uv(reference, uv),
                                   footprint_uv * footprint_scale(reference), reference.wrap_u,
                                   reference.wrap_v);
}

Rgb MaterialTable::base_color(scene::Index material, const Vec2& uv, float footprint_uv) const {
  const Entry& entry = materials_[material];
  return entry.material.base_color * Rgb(read(entry.base_color, uv, footprint_uv));
}

Rgb MaterialTable::base_color(scene::Index material, const PatternPoint& at) const {
  const scene::Material& m = materials_[material].material;
  if (!m.pattern) return m.base_color;
  return glm::mix(m.base_color, m.pattern->second_color, second_share(*m.pattern, at));
}

Rgb MaterialTable::base_color(const Surface& surface, const SampleFootprint& footprint) const {
  if (!materials_[surface.material].material.pattern) {
    return base_color(surface.material, surface.uv, footprint.uv);
  }
  const Vec3& normal = surface.geometric_normal;
  const Vec3 box = covered_box(normal, footprint.to_eye, footprint.width_m);
  return base_color(surface.material, PatternPoint{Vec3(surface.position), normal, box});
}

Bsdf MaterialTable::bsdf(const Surface& surface, const SampleFootprint& footprint,
                         MaterialModel model) const {
  if (!materials_[surface.material].material.pattern) {
    return bsdf(surface.material, surface.uv, footprint.uv, model);
  }
  return bsdf(surface.material, base_color(surface, footprint), model);
}

Rgb MaterialTable::emission(scene::Index material, const Vec2& uv, float footprint_uv) const {
  const Entry& entry = materials_[material];
  if (!entry.material.emits()) return Rgb{0.0F};
  return entry.material.emission * Rgb(read(entry.emission, uv, footprint_uv));
}

float MaterialTable::coverage(const Entry& entry, const Vec2& uv) const {
  const scene::Material& m = entry.material;
  if (m.alpha_mode == scene::AlphaMode::Opaque) return 1.0F;
  const float alpha = m.alpha * read(entry.base_color, uv, 0.0F).w;
  if (m.alpha_mode == scene::AlphaMode::Blend) return alpha;
  return alpha >= m.alpha_cutoff ? 1.0F : 0.0F;
}

Rgb MaterialTable::lamp_emission(scene::Index material, const Vec2& uv) const {
  return coverage(materials_[material], uv) * emission(material, uv, 0.0F);
}

float MaterialTable::lobe_width(scene::Index material, MaterialModel model) const {
  const Entry& entry = materials_[material];
  const scene::Material& m = entry.material;
  const bool reflects = m.specular > 0.0F || m.metallic > 0.0F;
  if (!reflects || model == MaterialModel::Lambert ||
      options_.specular_lobe == scene::StepUse::LeftOut)
    return 0.0F;
  const float mean =
      entry.metallic_roughness ? textures_[entry.metallic_roughness->texture].mean().y : 1.0F;
  const float roughness = m.roughness * mean;
  return std::clamp(roughness * roughness, kLeastAlpha, 1.0F);
}

const Rgb& MaterialTable::mean_emission(scene::Index material) const {
  return materials_[material].mean_emission;
}

bool MaterialTable::emits(scene::Index material) const {
  return materials_[material].material.emits();
}

bool MaterialTable::textured(scene::Index material) const {
  const Entry& entry = materials_[material];
  return entry.base_color || entry.metallic_roughness || entry.emission || entry.specular ||
         entry.specular_color;
}

}  // namespace macula::shading
