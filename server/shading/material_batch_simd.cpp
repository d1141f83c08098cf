// MaterialTable::bsdf in vectors; the function of one point is its oracle.
#include <cmath>

#include "server/shading/bsdf_batch.h"
#include "server/shading/ggx.h"
#include "server/shading/material_table.h"
#include "shared/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/shading/material_batch_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"
#include "server/sampling/vectors_simd.h"

#ifndef MACULA_SHADING_FACTOR_BATCHES
#define MACULA_SHADING_FACTOR_BATCHES
namespace macula::shading {

/// A material's factors, and what its textures show at every point; null: 1.
struct FactorBatches {
  float metallic, roughness, specular;
  Rgb specular_color;
  const TexelBatch *metallic_roughness, *specular_share, *specular_tint;
  LobeModel lobe;
  float least;  ///< reflectance of a lobe that is forced: f90, of Phong's f0
};

/// Where a texture is read: through its transform.
struct TextureReads {
  sampling::Vec2Batch uv;
  sampling::FloatBatch footprint_uv;
};

}  // namespace macula::shading
#endif

HWY_BEFORE_NAMESPACE();
namespace macula::shading::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using namespace sampling::HWY_NAMESPACE;

HWY_ATTR void transform_vectors(const scene::TextureRef& reference, const sampling::Vec2Batch& uv,
                                const sampling::FloatBatch& footprint_uv, std::size_t count,
                                TextureReads& out) {
  const Floats d;
  const float c = std::cos(reference.uv_rotation_rad), s = std::sin(reference.uv_rotation_rad);
  const float grown = std::sqrt(std::abs(reference.uv_scale.x * reference.uv_scale.y));
  const auto cosine = hn::Set(d, c), sine = hn::Set(d, s);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    auto x = hn::Mul(hn::Set(d, reference.uv_scale.x), hn::Load(d, uv.x + i));
    auto y = hn::Mul(hn::Set(d, reference.uv_scale.y), hn::Load(d, uv.y + i));
    if (reference.uv_rotation_rad != 0.0F) {
      const auto turned = hn::MulAdd(cosine, x, hn::Mul(sine, y));
      y = hn::MulSub(cosine, y, hn::Mul(sine, x));
      x = turned;
    }
    hn::Store(hn::Add(hn::Set(d, reference.uv_offset.x), x), d, out.uv.x + i);
    hn::Store(hn::Add(hn::Set(d, reference.uv_offset.y), y), d, out.uv.y + i);
    hn::Store(hn::Mul(hn::Set(d, grown), hn::Load(d, footprint_uv.at + i)), d,
              out.footprint_uv.at + i);
  }
}

HWY_ATTR void base_vectors(const Rgb& factor, const TexelBatch* texels, std::size_t count,
                           sampling::Vec3Batch& out) {
  const Floats d;
  const Vec3s scale = broadcast(factor);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    Vec3s base = scale;
    if (texels != nullptr) {
      base = {hn::Mul(scale.x, hn::Load(d, texels->channel[0].at + i)),
              hn::Mul(scale.y, hn::Load(d, texels->channel[1].at + i)),
              hn::Mul(scale.z, hn::Load(d, texels->channel[2].at + i))};
    }
    store(base, out, i);
  }
}

/// factor times a channel of a texture, where there is one.
HWY_INLINE HWY_ATTR FloatVec factor(float value, const TexelBatch* texels, int channel,
                                    std::size_t i) {
  const Floats d;
  const auto v = hn::Set(d, value);
  return texels == nullptr ? v : hn::Mul(v, hn::Load(d, texels->channel[channel].at + i));
}
HWY_INLINE HWY_ATTR FloatVec dielectric(FloatVec specular, FloatVec tint) {
  const Floats d;
  constexpr float kDielectricF0 = 0.04F;  // as material_table.cpp
  return hn::Mul(specular, hn::Min(hn::Mul(hn::Set(d, kDielectricF0), tint), hn::Set(d, 1.0F)));
}

HWY_INLINE HWY_ATTR Vec3s at_least(const Vec3s& v, FloatVec least) {
  return {hn::Max(v.x, least), hn::Max(v.y, least), hn::Max(v.z, least)};
}

HWY_ATTR void bsdf_vectors(const FactorBatches& f, std::size_t count, BsdfBatch& out) {
  const Floats d;
  const auto one = hn::Set(d, 1.0F), least = hn::Set(d, f.least);
  const bool phong = f.lobe == LobeModel::Phong;
  out.lobe = f.lobe;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto metallic = factor(f.metallic, f.metallic_roughness, 2, i);
    const auto roughness = factor(f.roughness, f.metallic_roughness, 1, i);
    const auto specular = factor(f.specular, f.specular_share, 3, i);
    const auto rest = hn::Sub(one, metallic);
    const Vec3s base = load(out.base, i);
    store(scaled(rest, base), out.albedo, i);
    const Vec3s head_on{dielectric(specular, factor(f.specular_color.x, f.specular_tint, 0, i)),
                        dielectric(specular, factor(f.specular_color.y, f.specular_tint, 1, i)),
                        dielectric(specular, factor(f.specular_color.z, f.specular_tint, 2, i))};
    const Vec3s f0 = plus(scaled(rest, head_on), metallic, base);
    const auto f90 = hn::Max(hn::MulAdd(rest, specular, metallic), least);
    store(phong ? at_least(f0, least) : f0, out.f0, i);
    hn::Store(phong ? hn::Zero(d) : f90, d, out.f90.at + i);
    const auto alpha = hn::Mul(roughness, roughness);
    hn::Store(hn::Min(hn::Max(alpha, hn::Set(d, kLeastAlpha)), one), d, out.alpha.at + i);
  }
}

/// Without a lobe.
HWY_ATTR void lambert_vectors(float share, std::size_t count, BsdfBatch& out) {
  const Floats d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    store(scaled(hn::Set(d, share), load(out.base, i)), out.albedo, i);
    store(broadcast(Rgb{0.0F}), out.f0, i);
    hn::Store(hn::Zero(d), d, out.f90.at + i);
    hn::Store(hn::Set(d, 1.0F), d, out.alpha.at + i);
  }
}

}  // namespace macula::shading::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::shading {

HWY_EXPORT(transform_vectors);
HWY_EXPORT(base_vectors);
HWY_EXPORT(bsdf_vectors);
HWY_EXPORT(lambert_vectors);

const TexelBatch* MaterialTable::read(const std::optional<Lookup>& lookup,
                                      const SurfaceBatch& surfaces,
                                      const sampling::FloatBatch& footprint_uv, std::size_t count,
                                      unsigned channels, TexelBatch& room) const {
  if (!lookup) return nullptr;
  const scene::TextureRef& reference = lookup->reference;
  TextureReads reads;
  HWY_DYNAMIC_DISPATCH(transform_vectors)(reference, surfaces.uv, footprint_uv, count, reads);
  textures_[lookup->texture].sample(reads.uv, reads.footprint_uv, reference.wrap_u,
                                    reference.wrap_v, count, channels, room);
  return &room;
}

void MaterialTable::base_colors(scene::Index material, const SurfaceBatch& surfaces,
                                const FootprintBatch& footprints, std::size_t count,
                                sampling::Vec3Batch& out) const {
  const Entry& entry = materials_[material];
  if (entry.material.pattern) {
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 normal = surfaces.geometric[i];
      const Vec3 box = covered_box(normal, footprints.to_eye[i], footprints.width_m.at[i]);
      out.set(i, base_color(material, PatternPoint{surfaces.position[i], normal, box}));
    }
    return;
  }
  TexelBatch room;
  const TexelBatch* texels =
      read(entry.base_color, surfaces, footprints.uv, count, kColorChannels, room);
  HWY_DYNAMIC_DISPATCH(base_vectors)(entry.material.base_color, texels, count, out);
}

void MaterialTable::bsdf(scene::Index material, const SurfaceBatch& surfaces,
                         const FootprintBatch& footprints, std::size_t count, MaterialModel model,
                         BsdfBatch& out) const {
  base_colors(material, surfaces, footprints, count, out.base);
  const Entry& entry = materials_[material];
  const scene::Material& m = entry.material;
  const bool lambert = model == MaterialModel::Lambert;
  if (lambert || options_.specular_lobe == scene::StepUse::LeftOut) {
    const float share = lambert ? 1.0F : 1.0F - m.metallic;
    HWY_DYNAMIC_DISPATCH(lambert_vectors)(share, count, out);
    out.lobe = LobeModel::Ggx;
    return;
  }
  // Patterns stand where there are no texture coordinates for the other textures either.
  const auto texels = [&](const std::optional<Lookup>& lookup, unsigned channels,
                          TexelBatch& room) -> const TexelBatch* {
    return m.pattern ? nullptr : read(lookup, surfaces, footprints.uv, count, channels, room);
  };
  TexelBatch rooms[3];
  const FactorBatches factors{
      m.metallic,
      m.roughness,
      m.specular,
      m.specular_color,
      texels(entry.metallic_roughness, kColorChannels, rooms[0]),
      texels(entry.specular, kAlphaChannel, rooms[1]),
      texels(entry.specular_color, kColorChannels, rooms[2]),
      model == MaterialModel::Phong ? LobeModel::Phong : LobeModel::Ggx,
      options_.specular_lobe == scene::StepUse::Forced ? kFaintestLobe : 0.0F};
  HWY_DYNAMIC_DISPATCH(bsdf_vectors)(factors, count, out);
}

}  // namespace macula::shading
#endif
