// Four lanes hold one colour, so that a tap is one load, one multiplication and one addition; wider
// vectors would need gathers, which cost more than they save.
#include <algorithm>
#include <cmath>

#include "client/reprojection/resolve.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "client/reprojection/resolve_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

#ifndef MACULA_CLIENT_REPROJECTION_RESOLVE_SIMD_ONCE
#define MACULA_CLIENT_REPROJECTION_RESOLVE_SIMD_ONCE
namespace macula::reprojection {

/// One colour in float, red to blue; the fourth lane is 0.
struct alignas(16) Texel {
  float channel[4];
};

/// The source in float with its outermost cells repeated: one before, two after, as four taps need.
class PaddedSource {
 public:
  explicit PaddedSource(const image::Plane<Rgb8>& source)
      : texels_(source.width() + 3, source.height() + 3),
        last_(static_cast<float>(source.width() - 1), static_cast<float>(source.height() - 1)) {
    for (int y = 0; y < texels_.height(); ++y) {
      const auto from = source.row(std::clamp(y - 1, 0, source.height() - 1));
      const auto to = texels_.row(y);
      for (int x = 0; x < texels_.width(); ++x) {
        const Rgb8 c = from[static_cast<std::size_t>(std::clamp(x - 1, 0, source.width() - 1))];
        to[static_cast<std::size_t>(x)] = {
            {static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b), 0.0F}};
      }
    }
  }
  /// Cell coordinates within the cell centres.
  Vec2 clamped(float u, float v) const {
    return {std::min(std::max(u, 0.0F), last_.x), std::min(std::max(v, 0.0F), last_.y)};
  }
  /// The first of four taps in row `row` (0..3) around cell (x, y): cells x - 1 to x + 2.
  const float* taps(int x, int y, int row) const { return texels_(x, y + row).channel; }

 private:
  image::Plane<Texel> texels_;
  Vec2 last_;
};

/// Weights of cells -1, 0, 1, 2 at t in [0, 1) beyond cell 0.
struct Weights {
  float w[4];
};
inline Weights bilinear(float t) {
  return {{0.0F, 1.0F - t, t, 0.0F}};
}
/// Catmull and Rom (1974), tension 1/2.
inline Weights catmull_rom(float t) {
  const float t2 = t * t, t3 = t2 * t;
  return {{0.5F * (-t3 + 2.0F * t2 - t), 0.5F * (3.0F * t3 - 5.0F * t2 + 2.0F),
           0.5F * (-3.0F * t3 + 4.0F * t2 + t), 0.5F * (t3 - t2)}};
}

}  // namespace macula::reprojection
#endif  // MACULA_CLIENT_REPROJECTION_RESOLVE_SIMD_ONCE

HWY_BEFORE_NAMESPACE();
namespace macula::reprojection::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::CappedTag<float, 4>;
using Color = hn::Vec<Lanes>;

HWY_INLINE HWY_ATTR Color weighted(const float* taps, const Weights& w) {
  const Lanes d;
  const auto first = hn::Add(hn::Mul(hn::Load(d, taps), hn::Set(d, w.w[0])),
                             hn::Mul(hn::Load(d, taps + 4), hn::Set(d, w.w[1])));
  const auto second = hn::Add(hn::Mul(hn::Load(d, taps + 8), hn::Set(d, w.w[2])),
                              hn::Mul(hn::Load(d, taps + 12), hn::Set(d, w.w[3])));
  return hn::Add(first, second);
}

HWY_INLINE HWY_ATTR Rgb8 rounded(Color color) {
  const Lanes d;
  const hn::RebindToSigned<Lanes> di;
  const auto bounded = hn::Min(hn::Max(color, hn::Zero(d)), hn::Set(d, 255.0F));
  alignas(16) std::int32_t lanes[4];
  hn::Store(hn::ConvertTo(di, hn::Add(bounded, hn::Set(d, 0.5F))), di, lanes);
  return {static_cast<std::uint8_t>(lanes[0]), static_cast<std::uint8_t>(lanes[1]),
          static_cast<std::uint8_t>(lanes[2])};
}

template <Weights (*kWeights)(float)>
HWY_ATTR void resolve(const Fragments& fragments, const PaddedSource& source,
                      image::Plane<Rgb8>& out) {
  const Lanes d;
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const Fragment& fragment = fragments.data()[i];
    if (!fragment.drawn()) continue;
    const Vec2 at = source.clamped(fragment.u, fragment.v);
    const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
    const Weights across = kWeights(at.x - static_cast<float>(x));
    const Weights down = kWeights(at.y - static_cast<float>(y));
    auto sum = hn::Zero(d);
    for (int row = 0; row < 4; ++row) {
      sum =
          hn::Add(sum, hn::Mul(hn::Set(d, down.w[row]), weighted(source.taps(x, y, row), across)));
    }
    out.data()[i] = rounded(sum);
  }
}

HWY_ATTR void resolve_bilinear(const Fragments& fragments, const PaddedSource& source,
                               image::Plane<Rgb8>& out) {
  resolve<bilinear>(fragments, source, out);
}
HWY_ATTR void resolve_catmull_rom(const Fragments& fragments, const PaddedSource& source,
                                  image::Plane<Rgb8>& out) {
  resolve<catmull_rom>(fragments, source, out);
}

}  // namespace macula::reprojection::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::reprojection {

HWY_EXPORT(resolve_bilinear);
HWY_EXPORT(resolve_catmull_rom);

void resolve_colors(const Fragments& fragments, const image::Plane<Rgb8>& source,
                    WarpOptions::Filter filter, image::Plane<Rgb8>& out) {
  out.resize(fragments.width(), fragments.height());
  const PaddedSource padded(source);
  switch (filter) {
    case WarpOptions::Filter::Bilinear:
      return HWY_DYNAMIC_DISPATCH(resolve_bilinear)(fragments, padded, out);
    case WarpOptions::Filter::CatmullRom:
      return HWY_DYNAMIC_DISPATCH(resolve_catmull_rom)(fragments, padded, out);
  }
}

}  // namespace macula::reprojection
#endif  // HWY_ONCE
