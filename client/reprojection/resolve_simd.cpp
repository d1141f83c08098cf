// Sixteen display pixels at a time: where they come from in whole vectors, then one after the
// other, the colours of each in whole vectors, because gathers cost more than they save.
// Multiplications and additions stay apart: the same bits on every instruction set.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "client/reprojection/raster_rules.h"
#include "client/reprojection/resolve.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "client/reprojection/resolve_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

#ifndef MACULA_CLIENT_REPROJECTION_RESOLVE_SIMD_ONCE
#define MACULA_CLIENT_REPROJECTION_RESOLVE_SIMD_ONCE
namespace macula::reprojection {

inline constexpr int kGroup = 16;  ///< pixels

/// What a picture is resolved with.
struct Resolving {
  const Fragments& fragments;
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

HWY_INLINE HWY_ATTR void find_places(const Resolving& r, int x, int y, int count, Places& places) {
  const Floats d;
  const Ints di;
  places.drawn = places.fine = places.hidden = 0;
  for (int i = 0; i < kGroup; i += kLanes) {
    const F u = hn::LoadU(d, r.fragments.us(y) + x + i),
            row = hn::LoadU(d, r.fragments.vs(y) + x + i);
    const F second = set(static_cast<float>(kSecondLayerRow));
    const auto hidden = hn::Ge(row, hn::Sub(second, set(1.0F)));  // half a cell beyond its edge
    const F v = hn::Sub(row, hn::IfThenElseZero(hidden, second));
    const auto drawn = hn::Ge(hn::LoadU(d, r.fragments.inverse_depths(y) + x + i), set(0.0F));
    const Cell across = cell_at(hn::IfThenElseZero(drawn, u), r.source.width());
    const Cell down = cell_at(hn::IfThenElseZero(drawn, v), r.source.height());
    hn::Store(across.before, di, places.column + i);
    hn::Store(across.beyond, d, places.across + i);
    hn::Store(down.before, di, places.row + i);
    hn::Store(down.beyond, d, places.down + i);
    const auto fine =
        hn::And(hn::And(hn::Ge(u, set(r.fine.u.first)), hn::Le(u, set(r.fine.u.last))),
                hn::And(hn::Ge(v, set(r.fine.v.first)), hn::Le(v, set(r.fine.v.last))));
    places.drawn |= bits_of(drawn) << i;
    places.fine |= bits_of(fine) << i;
    places.hidden |= bits_of(hidden) << i;
  }
  places.drawn &= (std::uint32_t{1} << count) - 1;
  places.fine &= places.drawn;
}

// ---- four colours at a time ----

using Bytes = hn::Full128<std::uint8_t>;
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

/// For all channels of the pixels k, k + 1, ... of a vector of weights, a pixel per 16 bytes.
struct PixelWeights {
  W down, up, across;  ///< across: of the left colour in the lower, of the right in the upper half
};
HWY_INLINE HWY_ATTR PixelWeights pixel_weights(const Places& places, int first, int k) {
  const Floats d;
  const Doubles d32;
  const Words d16;
  const auto fixed = [&](const float* beyond) HWY_ATTR {
    const F scaled = hn::Mul(hn::Load(d, beyond + first), set(65535.0F));
    const auto word = hn::BitCast(d32, hn::ConvertTo(Ints(), hn::Add(scaled, set(0.5F))));
    return hn::Or(word, hn::ShiftLeft<16>(word));
  };
  alignas(64) std::int32_t pixel_of_lane[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) pixel_of_lane[lane] = k + lane / 4;
  const auto pixels = hn::SetTableIndices(d32, pixel_of_lane);
  const W down = hn::BitCast(d16, hn::TableLookupLanes(fixed(places.down), pixels));
  const W across = hn::BitCast(d16, hn::TableLookupLanes(fixed(places.across), pixels));
  alignas(16) static constexpr std::uint16_t kLeft[8] = {65535, 65535, 65535, 65535, 0, 0, 0, 0};
  return {down, hn::Not(down), hn::Xor(across, hn::LoadDup128(d16, kLeft))};
}

/// Of two rows of eight bytes a pixel, two colours each: the mixed colour times 256, in its first
/// three words.
HWY_INLINE HWY_ATTR W mixed(const std::uint8_t* rows, const PixelWeights& weights) {
  const hn::Repartition<std::uint8_t, Floats> d8;
  const Words d16;
  alignas(16) static constexpr std::uint8_t kUpper[16] = {128, 0, 128, 1, 128, 2, 128, 128,
                                                          128, 3, 128, 4, 128, 5, 128, 128};
  alignas(16) static constexpr std::uint8_t kLower[16] = {128, 8,  128, 9,  128, 10, 128, 128,
                                                          128, 11, 128, 12, 128, 13, 128, 128};
  const auto bytes = hn::Load(d8, rows);
  const W upper = hn::BitCast(d16, hn::TableLookupBytesOr0(bytes, hn::LoadDup128(d8, kUpper)));
  const W lower = hn::BitCast(d16, hn::TableLookupBytesOr0(bytes, hn::LoadDup128(d8, kLower)));
  const W columns = hn::Add(hn::MulHigh(upper, weights.up), hn::MulHigh(lower, weights.down));
  const W parts = hn::MulHigh(columns, weights.across);
  return hn::Add(parts, hn::ShiftRightBytes<8>(d16, parts));
}

/// Eight bytes of the upper and of the lower row from a place on.
HWY_INLINE void copy_two_rows(const image::Plane<Rgb8>& source, int column, int row,
                              std::uint8_t* to) {
  const std::size_t row_bytes = 3 * static_cast<std::size_t>(source.width());
  if (column <= source.width() - 3 && row <= source.height() - 2) {  // eight bytes exist in both
    const std::uint8_t* upper = bytes_of(source) + static_cast<std::size_t>(row) * row_bytes +
                                3 * static_cast<std::size_t>(column);
    std::memcpy(to, upper, 8);
    std::memcpy(to + 8, upper + row_bytes, 8);
    return;
  }
  BorderTaps border;
  const Taps taps = border.around(source, column, row);
  std::memcpy(to, taps.rows[1] + 3, 8);
  std::memcpy(to + 8, taps.rows[2] + 3, 8);
}

HWY_INLINE HWY_ATTR void resolve_bilinear(const Resolving& r, const Places& places,
                                          Colors& colors) {
  const Words d16;
  const Doubles d32;
  alignas(64) std::uint8_t rows[kGroup][16];
  for (int i = 0; i < kGroup; ++i) {
    copy_two_rows(places.plane(r, static_cast<std::size_t>(i)), places.column[i], places.row[i],
                  rows[i]);
  }
  alignas(64) std::uint64_t words[kGroup][2];
  constexpr int kPixels = kLanes / 4;  // in a vector
  for (int i = 0; i < kGroup; i += kPixels) {
    const int first = i / kLanes * kLanes;
    const W color = mixed(rows[i], pixel_weights(places, first, i - first));
    const W rounded = hn::ShiftRight<8>(hn::Add(color, hn::Set(d16, 128)));
    hn::Store(hn::BitCast(hn::Repartition<std::uint64_t, Floats>(), rounded),
              hn::Repartition<std::uint64_t, Floats>(), words[i]);
  }
  static_cast<void>(d32);
  for (int i = 0; i < kGroup; ++i) {  // three words to three bytes
    const std::uint64_t w = words[i][0];
    colors.rgb[i] =
        static_cast<std::uint32_t>((w & 0xFF) | (w >> 8 & 0xFF00) | (w >> 16 & 0xFF0000));
  }
}

// ---- both ----

/// The first `count` of sixteen colours as bytes; black where nothing is drawn.
HWY_INLINE HWY_ATTR void write(const Colors& colors, std::uint32_t drawn, int count, Rgb8* out) {
  const Bytes d8;
  alignas(16) static constexpr std::uint8_t kPack[16] = {0,  1,  2,  4,  5,   6,   8,   9,
                                                         10, 12, 13, 14, 128, 128, 128, 128};
  const auto pack = hn::Load(d8, kPack);
  std::uint8_t bytes[3 * kGroup + 4];
  for (std::size_t i = 0; i < kGroup / 4; ++i) {
    const auto four = hn::Load(d8, reinterpret_cast<const std::uint8_t*>(colors.rgb + 4 * i));
    hn::StoreU(hn::TableLookupBytesOr0(four, pack), d8, bytes + 12 * i);
  }
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

HWY_ATTR void resolve_rows(const Resolving& r, image::Plane<Rgb8>& out) {
  Places places;
  Colors colors{};
  const int width = r.fragments.width();
  for (int y = r.fragments.first_row(); y < r.fragments.end_row(); ++y) {
    for (int x = 0; x < width; x += kGroup) {
      const int count = std::min(kGroup, width - x);
      find_places(r, x, y, count, places);
      if (places.fine != places.drawn) resolve_bilinear(r, places, colors);
      if (places.fine != 0) resolve_catmull_rom(r, places, colors);
      write(colors, places.drawn, count, &out(x, y));
    }
  }
}

}  // namespace macula::reprojection::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::reprojection {
namespace {

CellRange fine_range(const std::vector<float>& edges, double finest) {
  CellRange range;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    if (edges[i + 1] - edges[i] > finest) continue;
    if (range.first > range.last) range.first = static_cast<float>(i);
    range.last = static_cast<float>(i);
  }
  return range;
}

}  // namespace

HWY_EXPORT(resolve_rows);

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
  const DVec2 finest = static_cast<double>(WarpOptions::kFine_px) * display.pixel_tangent();
  return {fine_range(grid.x_edges, finest.x), fine_range(grid.y_edges, finest.y)};
}

Resolver::Resolver(const SourceView& source, const foveation::Display& display,
                   WarpOptions::Filter filter)
    : source_(source.color),
      hidden_(source.hidden != nullptr ? source.hidden->color : source.color),
      fine_(fine_ranges(source.grid, display, filter)) {}

void Resolver::resolve_band(const Fragments& fragments, image::Plane<Rgb8>& out) const {
  HWY_DYNAMIC_DISPATCH(resolve_rows)({fragments, source_, hidden_, fine_}, out);
}

}  // namespace macula::reprojection
#endif  // HWY_ONCE
