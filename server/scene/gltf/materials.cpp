#include "server/scene/gltf/materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/scene/gltf/images.h"
#include "shared/base/text.h"

namespace macula::scene::gltf {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();

double number(const tinygltf::Value& object, const char* key, double otherwise) {
  const tinygltf::Value& value = object.Get(key);
  return value.IsNumber() ? value.GetNumberAsDouble() : otherwise;
}

/// -1 for a number that is no index.
int integer(const tinygltf::Value& object, const char* key, int otherwise) {
  const double value = number(object, key, otherwise);
  return value >= 0.0 && value <= std::numeric_limits<int>::max() ? static_cast<int>(value) : -1;
}

std::vector<double> numbers(const tinygltf::Value& object, const char* key,
                            std::vector<double> otherwise) {
  const tinygltf::Value& value = object.Get(key);
  if (!value.IsArray() || value.ArrayLen() != otherwise.size()) return otherwise;
  for (std::size_t i = 0; i < otherwise.size(); ++i) {
    const tinygltf::Value& element = value.Get(static_cast<int>(i));
    if (element.IsNumber()) otherwise[i] = element.GetNumberAsDouble();
  }
  return otherwise;
}

/// An extension's object, or nullptr.
const tinygltf::Value* extension(const tinygltf::ExtensionMap& extensions, const char* name) {
  const auto found = extensions.find(name);
  return found != extensions.end() && found->second.IsObject() ? &found->second : nullptr;
}

Wrap wrap_mode(int gltf_mode) {
  switch (gltf_mode) {
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return Wrap::Clamp;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return Wrap::Mirror;
    default:
      return Wrap::Repeat;
  }
}

/// A texture that an extension's object names; index -1 where it names none.
tinygltf::TextureInfo texture_info(const tinygltf::Value& object, const char* key) {
  tinygltf::TextureInfo info;
  const tinygltf::Value& value = object.Get(key);
  if (!value.IsObject()) return info;
  info.index = integer(value, "index", -1);
  info.texCoord = integer(value, "texCoord", 0);
  const tinygltf::Value& extensions = value.Get("extensions");
  constexpr const char* kTransform = "KHR_texture_transform";
  if (extensions.IsObject() && extensions.Has(kTransform))
    info.extensions[kTransform] = extensions.Get(kTransform);
  return info;
}

class MaterialImporter {
 public:
  MaterialImporter(const Document& document, Scene& scene, Warnings& warnings)
      : document_(document), images_(document, scene), warnings_(warnings) {}

  /// texcoord_set: set to the first used one; -1 where no texture is used.
  Result<Material> import_material(std::size_t index, int& texcoord_set);

 private:
  Result<std::optional<TextureRef>> texture(const tinygltf::TextureInfo& info, ColorSpace space,
                                            int& texcoord_set);
  Result<Index> image_of(int texture, TextureRef& reference);
  void apply_transform(const tinygltf::Value& transform, TextureRef& reference);
  Result<void> import_textures(const tinygltf::Material& from, Material& to, int& texcoord_set);
  void import_factors(const tinygltf::Material& from, Material& to);
  void import_emission(const tinygltf::Material& from, Material& to);
  Result<void> import_specular(const tinygltf::Material& from, Material& to, int& texcoord_set);
  void warn_about_the_rest(const tinygltf::Material& from);
  float limited(double value, float low, float high, const char* what);
  Rgb limited_color(const std::vector<double>& values, float high, const char* what);

  const Document& document_;
  ImageImporter images_;
  Warnings& warnings_;
  std::string place_;
};

float MaterialImporter::limited(double value, float low, float high, const char* what) {
  const double inside = std::isfinite(value) ? std::clamp<double>(value, low, high) : low;
  if (inside != value)
    warnings_.add(base::concat(place_, ": ", what, " ", value, " taken as ", inside));
  return static_cast<float>(inside);
}

Rgb MaterialImporter::limited_color(const std::vector<double>& values, float high,
                                    const char* what) {
  Rgb color{0.0F};
  for (std::size_t i = 0; i < std::min<std::size_t>(3, values.size()); ++i) {
    color[static_cast<int>(i)] = limited(values[i], 0.0F, high, what);
  }
  return color;
}

Result<Index> MaterialImporter::image_of(int texture_index, TextureRef& reference) {
  const tinygltf::Texture* texture = find(document_.model.textures, texture_index);
  if (!texture) {
    return base::bad_input(base::concat("there is no texture ", texture_index), place_,
                           base::concat("there are ", document_.model.textures.size()));
  }
  if (texture->sampler >= 0) {
    const tinygltf::Sampler* sampler = find(document_.model.samplers, texture->sampler);
    if (!sampler) {
      return base::bad_input(base::concat("there is no sampler ", texture->sampler),
                             document_.place("texture", static_cast<std::size_t>(texture_index)),
                             base::concat("there are ", document_.model.samplers.size()));
    }
    reference.wrap_u = wrap_mode(sampler->wrapS);
    reference.wrap_v = wrap_mode(sampler->wrapT);
  }
  return images_.require(texture->source);
}

void MaterialImporter::apply_transform(const tinygltf::Value& transform, TextureRef& reference) {
  const std::vector<double> offset = numbers(transform, "offset", {0.0, 0.0});
  const std::vector<double> scale = numbers(transform, "scale", {1.0, 1.0});
  const double rotation = number(transform, "rotation", 0.0);
  for (int i = 0; i < 2; ++i) {
    reference.uv_offset[i] =
        limited(offset[static_cast<std::size_t>(i)], -kLargest, kLargest, "texture offset");
    reference.uv_scale[i] =
        limited(scale[static_cast<std::size_t>(i)], -kLargest, kLargest, "texture scale");
  }
  reference.uv_rotation_rad = limited(rotation, -kLargest, kLargest, "texture rotation");
}

Result<std::optional<TextureRef>> MaterialImporter::texture(const tinygltf::TextureInfo& info,
                                                            ColorSpace space, int& texcoord_set) {
  if (info.index < 0) return std::optional<TextureRef>{};
  TextureRef reference;
  reference.space = space;
  const Result<Index> image = image_of(info.index, reference);
  if (!image) return forward(image);
  reference.image = *image;
  int set = info.texCoord;
  if (const auto* transform = extension(info.extensions, "KHR_texture_transform")) {
    apply_transform(*transform, reference);
    set = static_cast<int>(number(*transform, "texCoord", set));
  }
  if (texcoord_set < 0) texcoord_set = set;
  if (texcoord_set != set) {
    warnings_.add(place_ +
                  ": its textures use different coordinate sets; the first one's is used for all");
  }
  return std::optional<TextureRef>{reference};
}

Result<void> MaterialImporter::import_textures(const tinygltf::Material& from, Material& to,
                                               int& texcoord_set) {
  const auto& pbr = from.pbrMetallicRoughness;
  auto base_color = texture(pbr.baseColorTexture, ColorSpace::Srgb, texcoord_set);
  if (!base_color) return forward(base_color);
  auto metallic_roughness = texture(pbr.metallicRoughnessTexture, ColorSpace::Linear, texcoord_set);
  if (!metallic_roughness) return forward(metallic_roughness);
  auto emission = texture(from.emissiveTexture, ColorSpace::Srgb, texcoord_set);
  if (!emission) return forward(emission);
  to.base_color_texture = *base_color;
  to.metallic_roughness_texture = *metallic_roughness;
  to.emission_texture = *emission;
  return {};
}

void MaterialImporter::import_factors(const tinygltf::Material& from, Material& to) {
  const auto& pbr = from.pbrMetallicRoughness;
  if (pbr.baseColorFactor.size() == 4) {
    to.base_color = limited_color(pbr.baseColorFactor, 1.0F, "baseColorFactor");
    to.alpha = limited(pbr.baseColorFactor[3], 0.0F, 1.0F, "baseColorFactor alpha");
  }
  to.metallic = limited(pbr.metallicFactor, 0.0F, 1.0F, "metallicFactor");
  to.roughness = limited(pbr.roughnessFactor, 0.0F, 1.0F, "roughnessFactor");
  to.double_sided = from.doubleSided;
  to.alpha_cutoff = limited(from.alphaCutoff, 0.0F, kLargest, "alphaCutoff");
  if (from.alphaMode == "MASK") {
    to.alpha_mode = AlphaMode::Mask;
  } else if (from.alphaMode == "BLEND") {
    to.alpha_mode = AlphaMode::Blend;
  } else if (from.alphaMode != "OPAQUE" && !from.alphaMode.empty()) {
    warnings_.add(place_ + ": alphaMode '" + from.alphaMode + "' taken as OPAQUE");
  }
}

void MaterialImporter::import_emission(const tinygltf::Material& from, Material& to) {
  to.emission = limited_color(from.emissiveFactor, 1.0F, "emissiveFactor");
  if (const auto* strength = extension(from.extensions, "KHR_materials_emissive_strength")) {
    // Far beyond the sun's 2e7 W/(sr m^2), and small enough that a float picture can hold it.
    constexpr float kBrightest = 1e12F;
    to.emission *=
        limited(number(*strength, "emissiveStrength", 1.0), 0.0F, kBrightest, "emissiveStrength");
  }
}

Result<void> MaterialImporter::import_specular(const tinygltf::Material& from, Material& to,
                                               int& texcoord_set) {
  const auto* specular = extension(from.extensions, "KHR_materials_specular");
  if (!specular) return {};
  to.specular = limited(number(*specular, "specularFactor", 1.0), 0.0F, 1.0F, "specularFactor");
  to.specular_color = limited_color(numbers(*specular, "specularColorFactor", {1.0, 1.0, 1.0}),
                                    kLargest, "specularColorFactor");
  auto strength =
      texture(texture_info(*specular, "specularTexture"), ColorSpace::Linear, texcoord_set);
  if (!strength) return forward(strength);
  auto color =
      texture(texture_info(*specular, "specularColorTexture"), ColorSpace::Srgb, texcoord_set);
  if (!color) return forward(color);
  to.specular_texture = *strength;
  to.specular_color_texture = *color;
  return {};
}

void MaterialImporter::warn_about_the_rest(const tinygltf::Material& from) {
  if (from.normalTexture.index >= 0) warnings_.add("normal textures are ignored");
  if (from.occlusionTexture.index >= 0) warnings_.add("occlusion textures are ignored");
  if (from.extensions.contains("KHR_materials_transmission")) {
    warnings_.add("transmission is ignored: glass is opaque");
  }
}

Result<Material> MaterialImporter::import_material(std::size_t index, int& texcoord_set) {
  const tinygltf::Material& from = document_.model.materials[index];
  place_ = document_.place("material", index);
  Material to;
  to.name = from.name;
  if (const auto textures = import_textures(from, to, texcoord_set); !textures) {
    return forward(textures);
  }
  import_factors(from, to);
  import_emission(from, to);
  if (const auto specular = import_specular(from, to, texcoord_set); !specular) {
    return forward(specular);
  }
  warn_about_the_rest(from);
  return to;
}

}  // namespace

Result<ImportedMaterials> import_materials(const Document& document, Scene& scene,
                                           Warnings& warnings) {
  MaterialImporter importer(document, scene, warnings);
  ImportedMaterials imported;
  for (std::size_t i = 0; i < document.model.materials.size(); ++i) {
    int texcoord_set = -1;
    Result<Material> material = importer.import_material(i, texcoord_set);
    if (!material) return forward(material);
    scene.materials.push_back(std::move(*material));
    imported.texcoord_sets.push_back(std::max(texcoord_set, 0));
  }
  // The glTF default: white, fully metallic, fully rough.
  Material fallback;
  fallback.name = "default";
  fallback.metallic = 1.0F;
  imported.fallback = static_cast<Index>(scene.materials.size());
  imported.texcoord_sets.push_back(0);
  scene.materials.push_back(std::move(fallback));
  return imported;
}

}  // namespace macula::scene::gltf
