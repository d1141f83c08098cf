#include "shared/codec/yuv_simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shared/codec/yuv_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace macula::codec::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Bytes = hn::CappedTag<std::uint8_t, kYuvRowPixels>;
using Words = hn::RepartitionToWide<Bytes>;  // even and odd pixels apart
using Shorts = hn::RebindToSigned<Words>;
using ByteVec = hn::Vec<Bytes>;
using ShortVec = hn::Vec<Shorts>;

// Levels are carried with 7 fractional bits: 255 x 128 = 32640 is the most that 16 bits hold.
constexpr int kFraction = 7;
constexpr double kRed = 0.2126, kGreen = 0.7152, kBlue = 0.0722;
constexpr double kBlueFromCb = 2.0 * (1.0 - kBlue), kRedFromCr = 2.0 * (1.0 - kRed);

constexpr std::int16_t q15(double value) {
  return static_cast<std::int16_t>(value * 32768.0 + (value < 0.0 ? -0.5 : 0.5));
}

/// a x factor, factor within +-1.
HWY_INLINE HWY_ATTR ShortVec times(ShortVec a, double factor) {
  return hn::MulFixedPoint15(a, hn::Set(Shorts(), q15(factor)));
}
HWY_INLINE HWY_ATTR ShortVec even(ByteVec v) {
  const Words w;
  return hn::BitCast(Shorts(), hn::And(hn::BitCast(w, v), hn::Set(w, std::uint16_t{0xFF})));
}
HWY_INLINE HWY_ATTR ShortVec odd(ByteVec v) {
  return hn::BitCast(Shorts(), hn::ShiftRight<8>(hn::BitCast(Words(), v)));
}
/// To whole levels, within 0..255.
HWY_INLINE HWY_ATTR ShortVec to_level(ShortVec fixed) {
  const Shorts d;
  const auto whole = hn::ShiftRight<kFraction>(
      hn::SaturatedAdd(fixed, hn::Set(d, std::int16_t{1 << (kFraction - 1)})));
  return hn::Min(hn::Max(whole, hn::Zero(d)), hn::Set(d, std::int16_t{255}));
}
HWY_INLINE HWY_ATTR ByteVec interleave(ShortVec evens, ShortVec odds) {
  const Words w;
  return hn::BitCast(Bytes(),
                     hn::Or(hn::BitCast(w, evens), hn::ShiftLeft<8>(hn::BitCast(w, odds))));
}

struct Pixels {
  ShortVec r, g, b;  // fixed point
};
HWY_INLINE HWY_ATTR ShortVec luma(const Pixels& p) {
  return hn::Add(hn::Add(times(p.r, kRed), times(p.g, kGreen)), times(p.b, kBlue));
}
HWY_INLINE HWY_ATTR Pixels fixed(ShortVec r, ShortVec g, ShortVec b) {
  return {hn::ShiftLeft<kFraction>(r), hn::ShiftLeft<kFraction>(g), hn::ShiftLeft<kFraction>(b)};
}

/// A vector of pixels as loaded.
struct Loaded {
  ByteVec r, g, b;
};
HWY_INLINE HWY_ATTR Loaded load(const Rgb8* row) {
  const Bytes d;
  Loaded pixels{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  hn::LoadInterleaved3(d, &row->r, pixels.r, pixels.g, pixels.b);
  return pixels;
}
HWY_INLINE HWY_ATTR void store_luma(const Loaded& p, std::uint8_t* y) {
  const auto evens = to_level(luma(fixed(even(p.r), even(p.g), even(p.b))));
  const auto odds = to_level(luma(fixed(odd(p.r), odd(p.g), odd(p.b))));
  hn::StoreU(interleave(evens, odds), Bytes(), y);
}
/// Mean of 2 x 2 pixels in fixed point: their sum times 2^7 / 4.
HWY_INLINE HWY_ATTR ShortVec mean4(ByteVec upper, ByteVec lower) {
  const auto sum = hn::Add(hn::Add(even(upper), odd(upper)), hn::Add(even(lower), odd(lower)));
  return hn::ShiftLeft<kFraction - 2>(sum);
}
/// A difference of fixed-point levels as a chroma byte.
HWY_INLINE HWY_ATTR void store_chroma(ShortVec difference, double factor, std::uint8_t* out) {
  const Shorts d;
  const auto level =
      to_level(hn::Add(times(difference, factor), hn::Set(d, std::int16_t{128 << kFraction})));
  const hn::Rebind<std::uint8_t, Shorts> narrow;
  hn::StoreU(hn::DemoteTo(narrow, level), narrow, out);
}

HWY_ATTR void rows_to_yuv_vectors(const Rgb8* upper, const Rgb8* lower, std::size_t width,
                                  std::uint8_t* y_upper, std::uint8_t* y_lower, std::uint8_t* u,
                                  std::uint8_t* v) {
  for (std::size_t x = 0; x < width; x += hn::Lanes(Bytes())) {
    const Loaded above = load(upper + x), below = load(lower + x);
    store_luma(above, y_upper + x);
    store_luma(below, y_lower + x);
    const Pixels mean{mean4(above.r, below.r), mean4(above.g, below.g), mean4(above.b, below.b)};
    const auto y = luma(mean);
    store_chroma(hn::Sub(mean.b, y), 1.0 / kBlueFromCb, u + x / 2);
    store_chroma(hn::Sub(mean.r, y), 1.0 / kRedFromCr, v + x / 2);
  }
}

/// Red, green and blue of every other pixel of a row, of its luma and what its chroma adds.
struct Added {
  ShortVec r, g, b;  // whole levels
};
HWY_INLINE HWY_ATTR ShortVec centred(const std::uint8_t* chroma) {
  const Shorts d;
  const hn::Rebind<std::uint8_t, Shorts> narrow;
  const auto level = hn::PromoteTo(d, hn::LoadU(narrow, chroma));
  return hn::ShiftLeft<kFraction>(hn::Sub(level, hn::Set(d, std::int16_t{128})));
}
/// chroma x factor in whole levels, factor within +-2: half of it in fixed point, one shift less.
HWY_INLINE HWY_ATTR ShortVec added(ShortVec halves) {
  const Shorts d;
  return hn::ShiftRight<kFraction - 1>(
      hn::Add(halves, hn::Set(d, std::int16_t{1 << (kFraction - 2)})));
}
HWY_INLINE HWY_ATTR Added chroma_of(const std::uint8_t* u, const std::uint8_t* v) {
  const auto cb = centred(u), cr = centred(v);
  return {added(times(cr, kRedFromCr / 2.0)),
          added(hn::Add(times(cb, -kBlueFromCb * kBlue / kGreen / 2.0),
                        times(cr, -kRedFromCr * kRed / kGreen / 2.0))),
          added(times(cb, kBlueFromCb / 2.0))};
}
HWY_INLINE HWY_ATTR ByteVec both(ShortVec y_even, ShortVec y_odd, ShortVec add) {
  const Shorts d;
  const auto clamp = [&](ShortVec level) HWY_ATTR {
    return hn::Min(hn::Max(level, hn::Zero(d)), hn::Set(d, std::int16_t{255}));
  };
  return interleave(clamp(hn::Add(y_even, add)), clamp(hn::Add(y_odd, add)));
}

HWY_ATTR void row_from_yuv_vectors(const std::uint8_t* y, const std::uint8_t* u,
                                   const std::uint8_t* v, std::size_t width, Rgb8* row) {
  const Bytes d;
  for (std::size_t x = 0; x < width; x += hn::Lanes(d)) {
    const auto lumas = hn::LoadU(d, y + x);
    const Added add = chroma_of(u + x / 2, v + x / 2);
    const auto y_even = even(lumas), y_odd = odd(lumas);
    hn::StoreInterleaved3(both(y_even, y_odd, add.r), both(y_even, y_odd, add.g),
                          both(y_even, y_odd, add.b), d, &row[x].r);
  }
}

}  // namespace macula::codec::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::codec {

HWY_EXPORT(rows_to_yuv_vectors);
HWY_EXPORT(row_from_yuv_vectors);

void rows_to_yuv(const Rgb8* upper, const Rgb8* lower, std::size_t width, std::uint8_t* y_upper,
                 std::uint8_t* y_lower, std::uint8_t* u, std::uint8_t* v) {
  HWY_DYNAMIC_DISPATCH(rows_to_yuv_vectors)(upper, lower, width, y_upper, y_lower, u, v);
}

void row_from_yuv(const std::uint8_t* y, const std::uint8_t* u, const std::uint8_t* v,
                  std::size_t width, Rgb8* row) {
  HWY_DYNAMIC_DISPATCH(row_from_yuv_vectors)(y, u, v, width, row);
}

}  // namespace macula::codec
#endif
