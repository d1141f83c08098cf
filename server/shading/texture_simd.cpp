// Texture::sample in vectors; the function of one place is its oracle.
#include "server/shading/texture.h"

#include "shared/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/shading/texture_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

#include "hwy/contrib/math/math-inl.h"
#include "server/sampling/vectors_simd.h"

#ifndef MACULA_SHADING_PYRAMID
#define MACULA_SHADING_PYRAMID
namespace macula::shading {

/// A texture as loops that gather see it.
struct Pyramid {
  const std::int32_t* levels;  ///< width, height, first texel
  std::int32_t last_level;
  const std::int32_t* texels;
  const float* decode;
  float side_texels;
  scene::Wrap wrap_u, wrap_v;
  unsigned channels;
};

}  // namespace macula::shading
#endif

HWY_BEFORE_NAMESPACE();
namespace macula::shading::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using namespace sampling::HWY_NAMESPACE;

/// Into [0, 1]; what is no number becomes 0.
HWY_INLINE HWY_ATTR FloatVec wrapped(FloatVec t, scene::Wrap wrap) {
  const Floats d;
  const auto finite = hn::IfThenElseZero(hn::IsFinite(t), t);
  const auto one = hn::Set(d, 1.0F), two = hn::Set(d, 2.0F);
  if (wrap == scene::Wrap::Repeat) return hn::Sub(finite, hn::Floor(finite));
  if (wrap == scene::Wrap::Clamp) return hn::Min(hn::Max(finite, hn::Zero(d)), one);
  const auto half = hn::Floor(hn::Mul(hn::Set(d, 0.5F), finite));
  const auto period = hn::NegMulAdd(two, half, finite);
  return hn::IfThenElse(hn::Gt(period, one), hn::Sub(two, period), period);
}

/// A neighbour one texel outside: the other end when repeating, else the border.
HWY_INLINE HWY_ATTR IntVec wrapped_texel(IntVec at, IntVec size, scene::Wrap wrap) {
  const Ints di;
  const auto zero = hn::Zero(di);
  if (wrap == scene::Wrap::Repeat) {
    const auto from_left = hn::IfThenElse(hn::Lt(at, zero), hn::Add(at, size), at);
    return hn::IfThenElse(hn::Lt(from_left, size), from_left, hn::Sub(from_left, size));
  }
  return hn::Min(hn::Max(at, zero), hn::Sub(size, hn::Set(di, 1)));
}

/// The two texels around a place on one axis, and the way from the first to the second.
struct Axis {
  IntVec first, second;
  FloatVec way;
};
HWY_INLINE HWY_ATTR Axis around(FloatVec at, IntVec size, scene::Wrap wrap) {
  const Floats d;
  const Ints di;
  const auto place = hn::MulSub(at, hn::ConvertTo(d, size), hn::Set(d, 0.5F));
  const auto left = hn::Floor(place);
  const auto first = hn::ConvertTo(di, left);
  return {wrapped_texel(first, size, wrap),
          wrapped_texel(hn::Add(first, hn::Set(di, 1)), size, wrap), hn::Sub(place, left)};
}

/// Four texels with the shares of the second column and row.
struct Quad {
  IntVec texel[4];
  FloatVec across, down;
};
HWY_INLINE HWY_ATTR Quad quad_at(const Pyramid& p, IntVec level, FloatVec u, FloatVec v) {
  const Ints di;
  const auto row = hn::Mul(level, hn::Set(di, 3));
  const auto width = hn::GatherIndex(di, p.levels, row);
  const auto height = hn::GatherIndex(di, p.levels + 1, row);
  const auto first = hn::GatherIndex(di, p.levels + 2, row);
  const Axis x = around(u, width, p.wrap_u), y = around(v, height, p.wrap_v);
  const auto upper = hn::Add(first, hn::Mul(y.first, width));
  const auto lower = hn::Add(first, hn::Mul(y.second, width));
  return {{hn::GatherIndex(di, p.texels, hn::Add(upper, x.first)),
           hn::GatherIndex(di, p.texels, hn::Add(upper, x.second)),
           hn::GatherIndex(di, p.texels, hn::Add(lower, x.first)),
           hn::GatherIndex(di, p.texels, hn::Add(lower, x.second))},
          x.way,
          y.way};
}

template <int kChannel>
HWY_INLINE HWY_ATTR FloatVec decoded(const float* decode, IntVec texel) {
  const Floats d;
  const Ints di;
  const auto moved = hn::ShiftRight<8 * kChannel>(hn::BitCast(Words(), texel));
  const auto code = hn::And(hn::BitCast(di, moved), hn::Set(di, 255));
  if constexpr (kChannel == 3) return hn::Mul(hn::ConvertTo(d, code), hn::Set(d, 1.0F / 255.0F));
  return hn::GatherIndex(d, decode, code);
}
HWY_INLINE HWY_ATTR FloatVec mixed(FloatVec a, FloatVec b, FloatVec t) {
  return hn::MulAdd(t, hn::Sub(b, a), a);
}
template <int kChannel>
HWY_INLINE HWY_ATTR FloatVec bilinear(const float* decode, const Quad& q) {
  const auto upper =
      mixed(decoded<kChannel>(decode, q.texel[0]), decoded<kChannel>(decode, q.texel[1]), q.across);
  const auto lower =
      mixed(decoded<kChannel>(decode, q.texel[2]), decoded<kChannel>(decode, q.texel[3]), q.across);
  return mixed(upper, lower, q.down);
}

/// The finer of the two levels, and the way to the next; both 0 for a texel or less.
struct LevelPlace {
  IntVec finer;
  FloatVec blend;
};
HWY_INLINE HWY_ATTR LevelPlace level_of(const Pyramid& p, FloatVec footprint_uv) {
  const Floats d;
  const Ints di;
  const auto one = hn::Set(d, 1.0F);
  const auto texels = hn::Mul(footprint_uv, hn::Set(d, p.side_texels));
  const auto wide = hn::IfThenElse(hn::Gt(texels, one), texels, one);
  const auto level = hn::Min(hn::Log2(d, wide), hn::Set(d, static_cast<float>(p.last_level)));
  const auto finer = hn::ConvertTo(di, level);
  return {finer, hn::Sub(level, hn::ConvertTo(d, finer))};
}

template <int kChannel>
HWY_INLINE HWY_ATTR void write(const Pyramid& p, const Quad& near, const Quad& far, FloatVec blend,
                               bool between, std::size_t i, TexelBatch& out) {
  if ((p.channels & (1U << kChannel)) == 0) return;
  auto value = bilinear<kChannel>(p.decode, near);
  if (between) value = mixed(value, bilinear<kChannel>(p.decode, far), blend);
  hn::Store(value, Floats(), out.channel[kChannel].at + i);
}

HWY_ATTR void sample_vectors(const Pyramid& p, const sampling::Vec2Batch& uv,
                             const sampling::FloatBatch& footprint_uv, std::size_t count,
                             TexelBatch& out) {
  const Floats d;
  const Ints di;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto u = wrapped(hn::Load(d, uv.x + i), p.wrap_u);
    const auto v = wrapped(hn::Load(d, uv.y + i), p.wrap_v);
    const LevelPlace level = level_of(p, hn::Load(d, footprint_uv.at + i));
    const bool between = !hn::AllFalse(d, hn::Gt(level.blend, hn::Zero(d)));
    const Quad near = quad_at(p, level.finer, u, v);
    const auto coarser = hn::Min(hn::Add(level.finer, hn::Set(di, 1)), hn::Set(di, p.last_level));
    const Quad far = between ? quad_at(p, coarser, u, v) : near;
    write<0>(p, near, far, level.blend, between, i, out);
    write<1>(p, near, far, level.blend, between, i, out);
    write<2>(p, near, far, level.blend, between, i, out);
    write<3>(p, near, far, level.blend, between, i, out);
  }
}

}  // namespace macula::shading::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::shading {

HWY_EXPORT(sample_vectors);

void Texture::sample(const sampling::Vec2Batch& uv, const sampling::FloatBatch& footprint_uv,
                     scene::Wrap wrap_u, scene::Wrap wrap_v, std::size_t count, unsigned channels,
                     TexelBatch& out) const {
  static_assert(sizeof(Level) == 3 * sizeof(std::int32_t) && sizeof(image::Rgba8) == 4);
  MACULA_DCHECK(count <= sampling::kBatch);
  const Pyramid pyramid{&levels_.front().width,
                        static_cast<std::int32_t>(levels_.size()) - 1,
                        reinterpret_cast<const std::int32_t*>(texels_.data()),
                        decode_,
                        side_texels_,
                        wrap_u,
                        wrap_v,
                        channels};
  HWY_DYNAMIC_DISPATCH(sample_vectors)(pyramid, uv, footprint_uv, count, out);
}

}  // namespace macula::shading
#endif
