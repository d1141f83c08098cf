#include "server/scene/assimp/read_materials.h"

#include <assimp/ObjMaterial.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "server/scene/scene.h"

namespace macula::scene::assimp {
namespace {

std::optional<float> number(const aiMaterial& from, const char* key, unsigned type,
                            unsigned index) {
  ai_real value = 0;
  if (from.Get(key, type, index, value) != aiReturn_SUCCESS) return std::nullopt;
  return static_cast<float>(value);
}

std::optional<Rgb> color(const aiMaterial& from, const char* key, unsigned type, unsigned index) {
  aiColor3D value;
  if (from.Get(key, type, index, value) != aiReturn_SUCCESS) return std::nullopt;
  return Rgb(value.r, value.g, value.b);
}

std::uint8_t wrap_of(aiTextureMapMode mode) {
  switch (mode) {
    case aiTextureMapMode_Clamp:
    case aiTextureMapMode_Decal:
      return static_cast<std::uint8_t>(Wrap::Clamp);
    case aiTextureMapMode_Mirror:
      return static_cast<std::uint8_t>(Wrap::Mirror);
    default:
      return static_cast<std::uint8_t>(Wrap::Repeat);
  }
}

ParcelTexture texture(const aiMaterial& from, aiTextureType type, Warnings& warnings) {
  if (from.GetTextureCount(type) == 0) return {};
  if (from.GetTextureCount(type) > 1) warnings.add("of several texture layers the first is used");
  aiString path;
  aiTextureMapping mapping = aiTextureMapping_UV;
  unsigned set = 0;
  aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
  if (from.GetTexture(type, 0, &path, &mapping, &set, nullptr, nullptr, modes) !=
      aiReturn_SUCCESS) {
    return {};
  }
  if (mapping != aiTextureMapping_UV) warnings.add("projected textures are laid by coordinates");
  if (set != 0) warnings.add("textures use the first coordinate set");
  aiUVTransform moved;
  if (from.Get(AI_MATKEY_UVTRANSFORM(type, 0), moved) == aiReturn_SUCCESS) {
    warnings.add("texture transforms are ignored");
  }
  if (path.C_Str()[0] == '*') {
    warnings.add("textures inside the file are ignored");
    return {};
  }
  return {path.C_Str(), wrap_of(modes[0]), wrap_of(modes[1])};
}

struct IgnoredTexture {
  aiTextureType type;
  const char* sentence;
};
constexpr IgnoredTexture kIgnored[] = {
    {aiTextureType_NORMALS, "normal and bump textures are ignored"},
    {aiTextureType_NORMAL_CAMERA, "normal and bump textures are ignored"},
    {aiTextureType_HEIGHT, "normal and bump textures are ignored"},
    {aiTextureType_DISPLACEMENT, "displacement textures are ignored"},
    {aiTextureType_SPECULAR, "textures of highlights are ignored"},
    {aiTextureType_SHININESS, "textures of highlights are ignored"},
    {aiTextureType_METALNESS, "textures of metalness and roughness are ignored"},
    {aiTextureType_DIFFUSE_ROUGHNESS, "textures of metalness and roughness are ignored"},
    {aiTextureType_REFLECTION, "reflection textures are ignored"},
    {aiTextureType_AMBIENT, "ambient and occlusion textures are ignored"},
    {aiTextureType_LIGHTMAP, "ambient and occlusion textures are ignored"},
    {aiTextureType_AMBIENT_OCCLUSION, "ambient and occlusion textures are ignored"},
};

float roughness_of_exponent(float exponent) {
  const float alpha = std::sqrt(2.0F / (std::max(exponent, 0.0F) + 2.0F));
  return std::sqrt(alpha);
}

void read_highlight(const aiMaterial& from, MaterialNumbers& to) {
  int illumination = 2;  // MTL: 0 and 1 have no highlight
  from.Get(AI_MATKEY_OBJ_ILLUM, illumination);
  Rgb specular = color(from, AI_MATKEY_COLOR_SPECULAR).value_or(Rgb{0.0F});
  if (const auto strength = number(from, AI_MATKEY_SHININESS_STRENGTH)) specular *= *strength;
  const float largest = std::max({specular.x, specular.y, specular.z});
  const auto metallic = number(from, AI_MATKEY_METALLIC_FACTOR);
  const float exponent = number(from, AI_MATKEY_SHININESS).value_or(0.0F);
  auto roughness = number(from, AI_MATKEY_ROUGHNESS_FACTOR);
  if (!metallic && exponent > 0.0F) roughness.reset();  // assimp's own guess from the exponent
  to.metallic = metallic.value_or(0.0F);
  to.roughness = roughness.value_or(roughness_of_exponent(exponent));
  if (metallic || roughness) {
    to.specular = 1.0F;  // physically based numbers: the ordinary dielectric beside the metal
  } else if (illumination >= 2 && largest > 0.0F && std::isfinite(largest)) {
    to.specular = std::min(2.0F * largest, 1.0F);
    to.specular_color = specular * (2.0F / to.specular);
  }
}

}  // namespace

ParcelMaterial read_material(const aiMaterial& from, Warnings& warnings) {
  ParcelMaterial to;
  to.name = from.GetName().C_Str();
  MaterialNumbers& numbers = to.numbers;
  to.base_color = texture(from, aiTextureType_BASE_COLOR, warnings);
  if (to.base_color.path.empty()) to.base_color = texture(from, aiTextureType_DIFFUSE, warnings);
  to.alpha = texture(from, aiTextureType_OPACITY, warnings);
  to.emission = texture(from, aiTextureType_EMISSIVE, warnings);
  const auto base = color(from, AI_MATKEY_BASE_COLOR);
  numbers.base_color = base ? *base : color(from, AI_MATKEY_COLOR_DIFFUSE).value_or(Rgb{0.8F});
  if (!to.base_color.path.empty() && numbers.base_color == Rgb{0.0F}) {
    numbers.base_color = Rgb{1.0F};
    warnings.add("a textured material of colour black is taken as white under its texture");
  }
  numbers.emission = color(from, AI_MATKEY_COLOR_EMISSIVE).value_or(Rgb{0.0F});
  if (const auto factor = number(from, AI_MATKEY_EMISSIVE_INTENSITY)) numbers.emission *= *factor;
  if (!to.emission.path.empty() && numbers.emission == Rgb{0.0F}) numbers.emission = Rgb{1.0F};
  numbers.alpha = number(from, AI_MATKEY_OPACITY).value_or(1.0F);
  read_highlight(from, numbers);
  int both_sides = 0;
  from.Get(AI_MATKEY_TWOSIDED, both_sides);
  numbers.double_sided = both_sides != 0 ? 1 : 0;
  for (const IgnoredTexture& ignored : kIgnored) {
    if (from.GetTextureCount(ignored.type) > 0) warnings.add(ignored.sentence);
  }
  return to;
}

ParcelMaterial plain_material() {
  ParcelMaterial plain;
  plain.name = "default";
  plain.numbers.base_color = Rgb{0.8F};
  return plain;
}

}  // namespace macula::scene::assimp
