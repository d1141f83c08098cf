// Sixteen display pixels at a time: where they come from in whole vectors, then between four cells
// many pixels at a time, of which a gather brings two neighbouring colours a lane; between sixteen
// one after the other, the colours of each in whole vectors.
// Multiplications and additions stay apart: the same bits on every instruction set.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include "client/reprojection/raster_rules.h"
#include "client/reprojection/resolve.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "client/reprojection/resolve_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"
// Below it:
#include "client/reprojection/packed_colors_simd.h"

#ifndef MACULA_CLIENT_REPROJECTION_RESOLVE_SIMD_ONCE
#define MACULA_CLIENT_REPROJECTION_RESOLVE_SIMD_ONCE
namespace macula::reprojection {

inline constexpr int kGroup = 16;  ///< pixels

/// What a picture is resolved with.
struct Resolving {
  const FragmentRow& fragments;
  const image::Plane<Rgb8>& source;
  const image::Plane<Rgb8>& hidden;  ///< of the same size
  FineRanges fine;
};

/// Of sixteen pixels: the cell before each and the distance from it, 0 to 1, along both axes.
struct Places {
  alignas(64) float u[kGroup], v[kGroup];
  alignas(64) std::int32_t column[kGroup], row[kGroup];
  alignas(64) float across[kGroup], down[kGroup];
  std::uint32_t drawn = 0, fine = 0, hidden = 0;  ///< a bit a pixel

  const image::Plane<Rgb8>& plane(const Resolving& r, std::size_t i) const {
    return (hidden >> i & 1) != 0 ? r.hidden : r.source;
  }
};

/// Sixteen colours: as floats, red first, and rounded, red in the lowest byte.
struct Colors {
  alignas(64) float exact[kGroup][4];
  alignas(64) std::uint32_t rgb[kGroup];
};

/// Of sixteen pixels: the weights of cells -1, 0, 1, 2 along one axis.
struct Weights {
  alignas(64) float of[kGroup][4];
};

/// Sixteen bytes of which four colours, three bytes each, are used, by row.
struct Taps {
  const std::uint8_t* rows[4];
};
/// Taps near the source's border, its outermost cells repeated.
struct BorderTaps {
  std::uint8_t bytes[4][16];
  Taps around(const image::Plane<Rgb8>& source, int column, int row) {
    Taps taps{};
    for (int j = 0; j < 4; ++j) {
      const auto from = source.row(std::clamp(row - 1 + j, 0, source.height() - 1));
      for (int i = 0; i < 4; ++i) {
        const Rgb8 c = from[std::clamp(column - 1 + i, 0, source.width() - 1)];
        bytes[j][3 * i] = c.r, bytes[j][3 * i + 1] = c.g, bytes[j][3 * i + 2] = c.b;
      }
      taps.rows[j] = bytes[j];
    }
    return taps;
  }
};
inline const std::uint8_t* bytes_of(const image::Plane<Rgb8>& source) {
  static_assert(sizeof(Rgb8) == 3);
  return reinterpret_cast<const std::uint8_t*>(source.data());
}

}  // namespace macula::reprojection
#endif  // MACULA_CLIENT_REPROJECTION_RESOLVE_SIMD_ONCE

HWY_BEFORE_NAMESPACE();
namespace macula::reprojection::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using F = hn::Vec<Floats>;
using I = hn::Vec<Ints>;
using Mask = hn::Mask<Floats>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(Floats()));

HWY_INLINE HWY_ATTR F set(float value) {
  return hn::Set(Floats(), value);
}
HWY_INLINE HWY_ATTR std::uint32_t bits_of(Mask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Floats(), mask, bytes);
  return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8;
}

/// The cell before a place, so that the next one exists too where there are two at all.
struct Cell {
  I before;
  F beyond;
};
HWY_INLINE HWY_ATTR Cell cell_at(F place, int size) {
  const Floats d;
  const Ints di;
  const F within = hn::Min(hn::Max(place, set(0.0F)), set(static_cast<float>(size - 1)));
  const I before =
      hn::Min(hn::ConvertTo(di, within), hn::Set(di, std::max(size - 2, 0)));  // rounds to zero
  return {before, hn::Sub(within, hn::ConvertTo(d, before))};
}

HWY_INLINE HWY_ATTR Mask within(const FineRanges& ranges, F u, F v) {
  return hn::And(hn::And(hn::Ge(u, set(ranges.u.first)), hn::Le(u, set(ranges.u.last))),
                 hn::And(hn::Ge(v, set(ranges.v.first)), hn::Le(v, set(ranges.v.last))));
}

/// Where a cell's row is without the second layer's offset.
struct LayerRow {
  F row;
  Mask hidden;
};
HWY_INLINE HWY_ATTR LayerRow layer_row(F row) {
  const F second = set(static_cast<float>(kSecondLayerRow));
  const auto hidden = hn::Ge(row, hn::Sub(second, set(1.0F)));  // half a cell beyond its edge
  return {hn::Sub(row, hn::IfThenElseZero(hidden, second)), hidden};
}

HWY_INLINE HWY_ATTR void find_places(const Resolving& r, int x, int count, Places& places) {
  const Floats d;
  const Ints di;
  places.drawn = places.fine = places.hidden = 0;
  for (int i = 0; i < kGroup; i += kLanes) {
    const F u = hn::LoadU(d, r.fragments.u + x + i);
    const auto [v, hidden] = layer_row(hn::LoadU(d, r.fragments.v + x + i));
    const auto drawn = hn::Ge(hn::LoadU(d, r.fragments.inverse_depth + x + i), set(0.0F));
    const Cell across = cell_at(hn::IfThenElseZero(drawn, u), r.source.width());
    const Cell down = cell_at(hn::IfThenElseZero(drawn, v), r.source.height());
    hn::Store(across.before, di, places.column + i);
    hn::Store(across.beyond, d, places.across + i);
    hn::Store(down.before, di, places.row + i);
    hn::Store(down.beyond, d, places.down + i);
    places.drawn |= bits_of(drawn) << i;
    places.fine |= bits_of(within(r.fine, u, v)) << i;
    places.hidden |= bits_of(hidden) << i;
  }
  places.drawn &= (std::uint32_t{1} << count) - 1;
  places.fine &= places.drawn;
}

// ---- four colours at a time ----

using Quad = hn::CappedTag<float, 4>;

alignas(16) constexpr std::uint8_t kSpread[16] = {0, 1, 2, 128, 3, 4,  5,  128,
                                                  6, 7, 8, 128, 9, 10, 11, 128};

/// Catmull and Rom (1974), tension 1/2, at t in [0, 1] beyond cell 0.
HWY_INLINE HWY_ATTR void catmull_rom(const float* beyond, Weights& weights) {
  const Floats d;
  const F half = set(0.5F);
  for (int i = 0; i < kGroup; i += kLanes) {
    const F t = hn::Load(d, beyond + i), t2 = hn::Mul(t, t), t3 = hn::Mul(t2, t);
    const F w0 = hn::Mul(half, hn::Sub(hn::Sub(hn::Add(t2, t2), t3), t));
    const F w1 =
        hn::Mul(half, hn::Add(hn::Sub(hn::Mul(set(3.0F), t3), hn::Mul(set(5.0F), t2)), set(2.0F)));
    const F w2 = hn::Mul(half, hn::Add(hn::Sub(hn::Mul(set(4.0F), t2), hn::Mul(set(3.0F), t3)), t));
    const F w3 = hn::Mul(half, hn::Sub(t3, t2));
    hn::StoreInterleaved4(w0, w1, w2, w3, d, weights.of[i]);
  }
}

/// As many channels as D has lanes, from kFirst on, of four colours (red, green, blue, 0).
template <std::size_t kFirst, class D>
HWY_INLINE HWY_ATTR hn::Vec<D> floats_of(D d, hn::Vec<Bytes> colors) {
  const hn::Rebind<std::int32_t, D> d32;
  const hn::Half<Bytes> half;
  if constexpr (hn::MaxLanes(D()) == 16) {
    return hn::ConvertTo(d, hn::PromoteTo(d32, colors));
  } else if constexpr (hn::MaxLanes(D()) == 8) {
    if constexpr (kFirst == 0) return hn::ConvertTo(d, hn::PromoteTo(d32, hn::LowerHalf(colors)));
    return hn::ConvertTo(d, hn::PromoteTo(d32, hn::UpperHalf(half, colors)));
  } else {
    const auto from = hn::ShiftRightBytes<kFirst>(Bytes(), colors);
    return hn::ConvertTo(d, hn::PromoteTo(d32, hn::LowerHalf(hn::LowerHalf(from))));
  }
}

/// The weight of the colour that each lane belongs to, from channel kFirst on.
template <std::size_t kFirst, class D>
HWY_INLINE HWY_ATTR hn::Vec<D> color_weights(D d, const float* weights) {
  alignas(64) static constexpr std::int32_t kColor[16] = {0, 0, 0, 0, 1, 1, 1, 1,
                                                          2, 2, 2, 2, 3, 3, 3, 3};
  return hn::TableLookupLanes(hn::LoadDup128(d, weights), hn::SetTableIndices(d, kColor + kFirst));
}

/// Four rows of colours mixed downwards, from channel kFirst on, weighted across.
template <std::size_t kFirst, class D>
HWY_INLINE HWY_ATTR hn::Vec<D> mixed_down(D d, const hn::Vec<Bytes>* rows, const float* across,
                                          const float* down) {
  const auto upper = hn::Add(hn::Mul(floats_of<kFirst>(d, rows[0]), hn::Set(d, down[0])),
                             hn::Mul(floats_of<kFirst>(d, rows[1]), hn::Set(d, down[1])));
  const auto lower = hn::Add(hn::Mul(floats_of<kFirst>(d, rows[2]), hn::Set(d, down[2])),
                             hn::Mul(floats_of<kFirst>(d, rows[3]), hn::Set(d, down[3])));
  return hn::Mul(hn::Add(upper, lower), color_weights<kFirst>(d, across));
}

template <class D>
HWY_INLINE HWY_ATTR hn::Vec<Quad> sum_of_two(D, hn::Vec<D> colors) {
  const Quad q;
  return hn::Add(hn::LowerHalf(q, colors), hn::UpperHalf(q, colors));
}

/// Sum of four colours: (first + second) + (third + fourth) on every instruction set. `part` gives
/// the channels from its template argument on.
template <class D, class Part>
HWY_INLINE HWY_ATTR hn::Vec<Quad> sum_of_four(D d, const Part& part) {
  if constexpr (hn::MaxLanes(D()) == 16) {
    const hn::Half<D> half;
    const auto all = part.template from<0>(d);
    return hn::Add(sum_of_two(half, hn::LowerHalf(half, all)),
                   sum_of_two(half, hn::UpperHalf(half, all)));
  } else if constexpr (hn::MaxLanes(D()) == 8) {
    return hn::Add(sum_of_two(d, part.template from<0>(d)),
                   sum_of_two(d, part.template from<8>(d)));
  } else {
    return hn::Add(hn::Add(part.template from<0>(d), part.template from<4>(d)),
                   hn::Add(part.template from<8>(d), part.template from<12>(d)));
  }
}

/// Four rows of four colours, weighted down and across.
struct Square {
  const hn::Vec<Bytes>* rows;
  const float *across, *down;
  template <std::size_t kFirst, class D>
  HWY_INLINE HWY_ATTR hn::Vec<D> from(D d) const {
    return mixed_down<kFirst>(d, rows, across, down);
  }
};

/// The colours named by `pixels`, from exact to rgb.
HWY_INLINE HWY_ATTR void round(std::uint32_t pixels, Colors& colors) {
  const Floats d;
  const hn::Rebind<std::uint8_t, Floats> d8;
  alignas(64) std::uint32_t rounded[kGroup];
  auto* const bytes = reinterpret_cast<std::uint8_t*>(rounded);
  for (int i = 0; i < 4 * kGroup; i += kLanes) {
    const F exact = hn::Load(d, colors.exact[0] + i);
    const F bounded = hn::Min(hn::Max(exact, hn::Zero(d)), set(255.0F));
    hn::StoreU(hn::DemoteTo(d8, hn::ConvertTo(Ints(), hn::Add(bounded, set(0.5F)))), d8, bytes + i);
  }
  for (int i = 0; i < kGroup; ++i) {
    if ((pixels >> i & 1) != 0) colors.rgb[i] = rounded[i];
  }
}

// ---- filters ----

HWY_INLINE HWY_ATTR void resolve_catmull_rom(const Resolving& r, const Places& places,
                                             Colors& colors) {
  const Bytes d8;
  const auto spread = hn::Load(d8, kSpread);
  Weights across, down;
  catmull_rom(places.across, across);
  catmull_rom(places.down, down);
  const int width = r.source.width(), height = r.source.height();
  for (std::uint32_t rest = places.fine; rest != 0; rest &= rest - 1) {
    const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
    const int column = places.column[i], row = places.row[i];
    const image::Plane<Rgb8>& source = places.plane(r, i);
    BorderTaps border;
    Taps taps;
    if (column >= 1 && row >= 1 && column <= width - 5 && row <= height - 3) {  // 16 bytes exist
      const std::size_t first =
          3 * (static_cast<std::size_t>(row - 1) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(column - 1));
      for (std::size_t j = 0; j < 4; ++j) {
        taps.rows[j] = bytes_of(source) + first + 3 * j * static_cast<std::size_t>(width);
      }
    } else {
      taps = border.around(source, column, row);
    }
    const hn::Vec<Bytes> rows[4] = {hn::TableLookupBytesOr0(hn::LoadU(d8, taps.rows[0]), spread),
                                    hn::TableLookupBytesOr0(hn::LoadU(d8, taps.rows[1]), spread),
                                    hn::TableLookupBytesOr0(hn::LoadU(d8, taps.rows[2]), spread),
                                    hn::TableLookupBytesOr0(hn::LoadU(d8, taps.rows[3]), spread)};
    hn::Store(sum_of_four(Floats(), Square{rows, across.of[i], down.of[i]}), Quad(),
              colors.exact[i]);
  }
  round(places.fine, colors);
}

/// Sixteen bits a channel: less than a hundredth of a step of eight from exact, and exact at
/// centres.
using Words = hn::Repartition<std::uint16_t, Floats>;
using Doubles = hn::Repartition<std::uint32_t, Floats>;
using W = hn::Vec<Words>;

/// For all channels of every other pixel of half a vector of weights, a pixel per 16 bytes.
struct PixelWeights {
  W down, up, across;  ///< across: of the left colour in the lower, of the right in the upper half
};
/// `down` and `across`: a pixel's weight twice in each 32 bits; pixels first, first + 2, ... of
/// them.
HWY_INLINE HWY_ATTR PixelWeights pixel_weights(hn::Vec<Doubles> down, hn::Vec<Doubles> across,
                                               int first) {
  const Doubles d32;
  const Words d16;
  alignas(64) std::int32_t pixel_of_lane[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) pixel_of_lane[lane] = first + lane / 4 * 2;
  const auto pixels = hn::SetTableIndices(d32, pixel_of_lane);
  const W of_lower = hn::BitCast(d16, hn::TableLookupLanes(down, pixels));
  const W of_right = hn::BitCast(d16, hn::TableLookupLanes(across, pixels));
  alignas(16) static constexpr std::uint16_t kLeft[8] = {65535, 65535, 65535, 65535, 0, 0, 0, 0};
  return {of_lower, hn::Not(of_lower), hn::Xor(of_right, hn::LoadDup128(d16, kLeft))};
}
HWY_INLINE HWY_ATTR hn::Vec<Doubles> weights_twice(const float* beyond) {
  const Floats d;
  const F scaled = hn::Mul(hn::Load(d, beyond), set(65535.0F));
  const auto word = hn::BitCast(Doubles(), hn::ConvertTo(Ints(), hn::Add(scaled, set(0.5F))));
  return hn::Or(word, hn::ShiftLeft<16>(word));
}

/// Two neighbouring colours of the upper and of the lower row, a pixel per lane, in its first six
/// bytes.
using Pair = hn::Repartition<std::uint64_t, Floats>;
struct Pairs {
  hn::Vec<Pair> upper, lower;
};
/// The mixed colours, times 256, of the lower (kOdd 0) or the upper (1) of two lanes, in the first
/// three words of 16 bytes.
template <int kOdd>
HWY_INLINE HWY_ATTR W mixed(const Pairs& pairs, const PixelWeights& weights) {
  const hn::Repartition<std::uint8_t, Floats> d8;
  const Words d16;
  constexpr std::uint8_t k = 8 * kOdd, kNone = 128;
  alignas(16) static constexpr std::uint8_t kSpreadPair[16] = {
      kNone, k,     kNone, k + 1, kNone, k + 2, kNone, kNone,
      kNone, k + 3, kNone, k + 4, kNone, k + 5, kNone, kNone};
  const auto spread = [&](hn::Vec<Pair> pair) HWY_ATTR {
    return hn::BitCast(
        d16, hn::TableLookupBytesOr0(hn::BitCast(d8, pair), hn::LoadDup128(d8, kSpreadPair)));
  };
  const W columns = hn::Add(hn::MulHigh(spread(pairs.upper), weights.up),
                            hn::MulHigh(spread(pairs.lower), weights.down));
  const W parts = hn::MulHigh(columns, weights.across);
  return hn::Add(parts, hn::ShiftRightBytes<8>(d16, parts));
}

/// Of half a vector of pixels, `first` of its weights on: two colours of four bytes in the first
/// half of each 16 bytes.
HWY_INLINE HWY_ATTR hn::Vec<Pair> colors_of(const Pairs& pairs, hn::Vec<Doubles> down,
                                            hn::Vec<Doubles> across, int first) {
  const Pair d64;
  const Words d16;
  const hn::Repartition<std::uint8_t, Floats> d8;
  const W even = mixed<0>(pairs, pixel_weights(down, across, first));
  const W odd = mixed<1>(pairs, pixel_weights(down, across, first + 1));
  const auto both = hn::InterleaveLower(d64, hn::BitCast(d64, even), hn::BitCast(d64, odd));
  const W rounded = hn::ShiftRight<8>(hn::Add(hn::BitCast(d16, both), hn::Set(d16, 128)));
  alignas(16) static constexpr std::uint8_t kBytes[16] = {0,   2,   4,   128, 8,   10,  12,  128,
                                                          128, 128, 128, 128, 128, 128, 128, 128};
  return hn::BitCast(d64,
                     hn::TableLookupBytesOr0(hn::BitCast(d8, rounded), hn::LoadDup128(d8, kBytes)));
}

/// Sixteen pixels' pairs of colours, one after the other.
struct CopiedPairs {
  alignas(64) std::uint64_t upper[kGroup], lower[kGroup];
};
HWY_INLINE void copy_pair(const image::Plane<Rgb8>& source, int column, int row,
                          std::uint64_t* upper, std::uint64_t* lower) {
  const std::size_t row_bytes = 3 * static_cast<std::size_t>(source.width());
  if (column <= source.width() - 3 && row <= source.height() - 2) {  // eight bytes exist in both
    const std::uint8_t* from = bytes_of(source) + static_cast<std::size_t>(row) * row_bytes +
                               3 * static_cast<std::size_t>(column);
    std::memcpy(upper, from, 8);
    std::memcpy(lower, from + row_bytes, 8);
    return;
  }
  BorderTaps border;
  const Taps taps = border.around(source, column, row);
  std::memcpy(upper, taps.rows[1] + 3, 8);
  std::memcpy(lower, taps.rows[2] + 3, 8);
}

/// Whether all sixteen pixels' pairs are the first layer's and eight bytes long in both rows.
HWY_INLINE HWY_ATTR bool may_gather(const Resolving& r, const Places& places) {
  constexpr std::size_t kMostCells = std::size_t{1} << 29;  // three bytes each: offsets are ints
  if (places.hidden != 0 || r.source.size() > kMostCells) return false;
  const Ints di;
  const I last_column = hn::Set(di, r.source.width() - 3);
  const I last_row = hn::Set(di, r.source.height() - 2);
  for (int i = 0; i < kGroup; i += kLanes) {
    const auto beyond = hn::Or(hn::Gt(hn::Load(di, places.column + i), last_column),
                               hn::Gt(hn::Load(di, places.row + i), last_row));
    if (!hn::AllFalse(di, beyond)) return false;
  }
  return true;
}
HWY_INLINE HWY_ATTR Pairs gather_pairs(const Resolving& r, const Places& places, int first) {
  const Pair d64;
  const hn::RebindToSigned<Pair> di64;
  const hn::Rebind<std::int32_t, Pair> di;
  const auto column = hn::Load(di, places.column + first);
  const auto cell =
      hn::Add(hn::Mul(hn::Load(di, places.row + first), hn::Set(di, r.source.width())), column);
  const auto offset = hn::PromoteTo(di64, hn::Mul(cell, hn::Set(di, 3)));
  const std::uint8_t* const upper = bytes_of(r.source);
  const std::uint8_t* const lower = upper + 3 * static_cast<std::size_t>(r.source.width());
  return {hn::GatherOffset(d64, reinterpret_cast<const std::uint64_t*>(upper), offset),
          hn::GatherOffset(d64, reinterpret_cast<const std::uint64_t*>(lower), offset)};
}

/// Resolves sixteen pixels whose pairs `pairs_from` gives, half a vector from a pixel on.
template <class PairsFrom>
HWY_INLINE HWY_ATTR void resolve_pairs(const Places& places, const PairsFrom& pairs_from,
                                       Colors& colors) {
  const Pair d64;
  constexpr int kHalf = kLanes / 2;
  for (int i = 0; i < kGroup; i += kLanes) {
    const auto down = weights_twice(places.down + i), across = weights_twice(places.across + i);
    const auto first = colors_of(pairs_from(i), down, across, 0);
    const auto second = colors_of(pairs_from(i + kHalf), down, across, kHalf);
    hn::Store(hn::BitCast(Doubles(), hn::ConcatEven(d64, second, first)), Doubles(),
              colors.rgb + i);
  }
}

HWY_INLINE HWY_ATTR void resolve_bilinear(const Resolving& r, const Places& places,
                                          Colors& colors) {
  if (may_gather(r, places)) {
    resolve_pairs(
        places, [&](int first) HWY_ATTR { return gather_pairs(r, places, first); }, colors);
    return;
  }
  CopiedPairs copied;
  for (int i = 0; i < kGroup; ++i) {
    copy_pair(places.plane(r, static_cast<std::size_t>(i)), places.column[i], places.row[i],
              copied.upper + i, copied.lower + i);
  }
  resolve_pairs(
      places,
      [&](int first) HWY_ATTR {
        const Pair d64;
        return Pairs{hn::Load(d64, copied.upper + first), hn::Load(d64, copied.lower + first)};
      },
      colors);
}

// ---- both ----

/// The first `count` of sixteen colours as bytes; black where nothing is drawn.
HWY_INLINE HWY_ATTR void write(const Colors& colors, std::uint32_t drawn, int count, Rgb8* out) {
  std::uint8_t bytes[3 * kGroup + 4];
  pack(colors.rgb, kGroup, bytes);
  if (count == kGroup) {
    std::memcpy(static_cast<void*>(out), bytes, std::size_t{3} * kGroup);
  } else {
    std::memcpy(static_cast<void*>(out), bytes, 3 * static_cast<std::size_t>(count));
  }
  const std::uint32_t wanted = (std::uint32_t{1} << count) - 1;
  for (std::uint32_t rest = wanted & ~drawn; rest != 0; rest &= rest - 1) {
    out[hwy::Num0BitsBelowLS1Bit_Nonzero32(rest)] = {};
  }
}

HWY_ATTR void resolve_row(const Resolving& r, int first, std::span<Rgb8> out) {
  Places places;
  Colors colors{};
  const int width = static_cast<int>(out.size());
  for (int x = 0; x < width; x += kGroup) {
    const int count = std::min(kGroup, width - x);
    find_places(r, first + x, count, places);
    if (places.fine != places.drawn) resolve_bilinear(r, places, colors);
    if (places.fine != 0) resolve_catmull_rom(r, places, colors);
    write(colors, places.drawn, count, out.data() + x);
  }
}

HWY_ATTR void resolve_words(const Resolving& r, int count, std::uint32_t* words) {
  const Doubles d;
  Places places;
  Colors colors;
  for (int x = 0; x < count; x += kGroup) {
    find_places(r, x, std::min(kGroup, count - x), places);
    resolve_bilinear(r, places, colors);
    for (int i = 0; i < kGroup; i += kLanes) {
      const auto bits = static_cast<std::uint16_t>(places.drawn >> i);
      const auto drawn = hn::LoadMaskBits(d, reinterpret_cast<const std::uint8_t*>(&bits));
      hn::StoreU(hn::IfThenElseZero(drawn, hn::Load(d, colors.rgb + i)), d, words + x + i);
    }
  }
}

/// Whether any of sixteen fragments, those before `count`, is drawn from within `ranges`.
HWY_INLINE HWY_ATTR bool any_within(const FragmentRow& row, int x, int count,
                                    const FineRanges& ranges) {
  const Floats d;
  std::uint32_t found = 0;
  for (int i = 0; i < kGroup; i += kLanes) {
    const auto drawn = hn::Ge(hn::LoadU(d, row.inverse_depth + x + i), hn::Zero(d));
    const F v = layer_row(hn::LoadU(d, row.v + x + i)).row;
    found |= bits_of(hn::And(drawn, within(ranges, hn::LoadU(d, row.u + x + i), v))) << i;
  }
  return (found & ((std::uint32_t{1} << std::min(kGroup, count - x)) - 1)) != 0;
}
HWY_ATTR FragmentSpan span_within(const FragmentRow& row, int count, const FineRanges& ranges) {
  int first = 0, end = (count + kGroup - 1) / kGroup * kGroup;
  while (first < end && !any_within(row, first, count, ranges)) first += kGroup;
  while (first < end && !any_within(row, end - kGroup, count, ranges)) end -= kGroup;
  return {first, std::min(end, count)};
}

}  // namespace macula::reprojection::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::reprojection {
namespace {

CellRange narrow_range(const std::vector<float>& edges, double widest) {
  CellRange range;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    if (edges[i + 1] - edges[i] > widest) continue;
    if (range.first > range.last) range.first = static_cast<float>(i);
    range.last = static_cast<float>(i);
  }
  return range;
}

}  // namespace

HWY_EXPORT(resolve_row);
HWY_EXPORT(resolve_words);
HWY_EXPORT(span_within);

FragmentSpan span_within(const FragmentRow& fragments, int count, const FineRanges& ranges) {
  return HWY_DYNAMIC_DISPATCH(span_within)(fragments, count, ranges);
}

FineRanges narrow_cells(const PixelGrid& grid, const foveation::Display& display, float widest_px) {
  const DVec2 widest = static_cast<double>(widest_px) * display.pixel_tangent();
  return {narrow_range(grid.x_edges, widest.x), narrow_range(grid.y_edges, widest.y)};
}

FineRanges fine_ranges(const PixelGrid& grid, const foveation::Display& display,
                       WarpOptions::Filter filter) {
  constexpr float kAll = std::numeric_limits<float>::infinity();
  switch (filter) {
    case WarpOptions::Filter::Bilinear:
      return {};
    case WarpOptions::Filter::CatmullRom:
      return {{-kAll, kAll}, {-kAll, kAll}};
    case WarpOptions::Filter::Fovea:
      break;
  }
  return narrow_cells(grid, display, WarpOptions::kFine_px);
}

Resolver::Resolver(const SourceView& source, const foveation::Display& display,
                   WarpOptions::Filter filter)
    : source_(source.color),
      hidden_(source.hidden != nullptr ? source.hidden->color : source.color),
      fine_(fine_ranges(source.grid, display, filter)) {}

void Resolver::resolve_row(const FragmentRow& fragments, int first, std::span<Rgb8> out) const {
  HWY_DYNAMIC_DISPATCH(resolve_row)({fragments, source_, hidden_, fine_}, first, out);
}

void Resolver::resolve_words(const FragmentRow& fragments, int count, std::uint32_t* words) const {
  HWY_DYNAMIC_DISPATCH(resolve_words)({fragments, source_, hidden_, fine_}, count, words);
}

}  // namespace macula::reprojection
#endif  // HWY_ONCE
