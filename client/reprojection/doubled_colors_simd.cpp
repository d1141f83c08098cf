// Integers throughout: the same bits on every instruction set.
#include "client/reprojection/doubled_colors.h"

#include <algorithm>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "client/reprojection/doubled_colors_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"
// Below it:
#include "client/reprojection/packed_colors_simd.h"

#ifndef MACULA_CLIENT_REPROJECTION_DOUBLED_COLORS_SIMD_ONCE
#define MACULA_CLIENT_REPROJECTION_DOUBLED_COLORS_SIMD_ONCE
namespace macula::reprojection {

/// Before the first and after the last fragment of a row: a whole vector.
inline constexpr int kAround = 16;

/// A row of fragments with its colours.
struct ColoredRow {
  const std::uint32_t* words;
  FragmentRow places;
};
/// Between two rows; and what hangs together in the nearer one.
struct MixedRow {
  std::uint32_t *red_blue, *green;
  const std::uint32_t* joined;
};

}  // namespace macula::reprojection
#endif  // MACULA_CLIENT_REPROJECTION_DOUBLED_COLORS_SIMD_ONCE

HWY_BEFORE_NAMESPACE();
namespace macula::reprojection::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using Words = hn::RebindToUnsigned<Floats>;
using Halves = hn::Repartition<std::uint16_t, Floats>;
using F = hn::Vec<Floats>;
using W = hn::Vec<Words>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(Floats()));

/// All bits set in lanes whose fragments are both drawn and of one surface.
HWY_INLINE HWY_ATTR W together(const FragmentRow& one, int x, const FragmentRow& other,
                               int other_x) {
  const Floats d;
  const auto apart = [&](const float* a, const float* b) HWY_ATTR {
    return hn::Abs(hn::Sub(hn::LoadU(d, a + x), hn::LoadU(d, b + other_x)));
  };
  const F most = hn::Max(apart(one.u, other.u), apart(one.v, other.v));
  const F farther =
      hn::Min(hn::LoadU(d, one.inverse_depth + x), hn::LoadU(d, other.inverse_depth + other_x));
  return hn::BitCast(Words(),
                     hn::VecFromMask(d, hn::And(hn::Ge(farther, hn::Zero(d)),
                                                hn::Le(most, hn::Set(d, kMostApart_cells)))));
}

HWY_ATTR void join_columns(const FragmentRow& row, int width, std::uint32_t* joined) {
  for (int x = 0; x < width; x += kLanes) {
    hn::StoreU(together(row, x, row, x + 1), Words(), joined + x);
  }
}

HWY_INLINE HWY_ATTR W choose(W which, W yes, W no) {
  return hn::Or(hn::And(which, yes), hn::AndNot(which, no));
}
/// 3 a + b in halves of 16 bits.
HWY_INLINE HWY_ATTR W three_and_one(W a, W b) {
  const Halves d;
  const auto of_a = hn::BitCast(d, a);
  return hn::BitCast(Words(), hn::Add(hn::Add(of_a, hn::Add(of_a, of_a)), hn::BitCast(d, b)));
}

HWY_ATTR void mix_rows(const ColoredRow& near, const ColoredRow& far, int first, int end,
                       const MixedRow& out) {
  const Words d;
  const W low = hn::Set(d, 0x00FF00FFU);
  for (int x = first; x < end; x += kLanes) {
    const W here = hn::LoadU(d, near.words + x);
    const W beside =
        choose(together(near.places, x, far.places, x), hn::LoadU(d, far.words + x), here);
    hn::StoreU(three_and_one(hn::And(here, low), hn::And(beside, low)), d, out.red_blue + x);
    hn::StoreU(three_and_one(hn::And(hn::ShiftRight<8>(here), low),
                             hn::And(hn::ShiftRight<8>(beside), low)),
               d, out.green + x);
  }
}

/// Sixteen times a colour, halves of it apart, as bytes.
HWY_INLINE HWY_ATTR W rounded(W red_blue, W green) {
  const Words d;
  const Halves d16;
  const auto part = [&](W sixteenfold) HWY_ATTR {
    return hn::ShiftRight<4>(hn::Add(hn::BitCast(d16, sixteenfold), hn::Set(d16, 8)));
  };
  return hn::Or(hn::BitCast(d, part(red_blue)), hn::BitCast(d, hn::ShiftLeft<8>(part(green))));
}

/// The first `count` of two vectors of colours. Where there is room for more of them, four bytes
/// beyond are written too.
HWY_INLINE HWY_ATTR void write(const std::uint32_t* colors, int count, int room, Rgb8* out) {
  constexpr int kCount = 2 * kLanes, kBeyond = 2;  // pixels
  std::uint8_t bytes[3 * (kCount + kBeyond)];
  const bool fits = count == kCount && room >= kCount + kBeyond;
  std::uint8_t* const to = fits ? reinterpret_cast<std::uint8_t*>(out) : bytes;
  pack(colors, kCount, to);
  if (!fits) std::memcpy(static_cast<void*>(out), bytes, 3 * static_cast<std::size_t>(count));
}

HWY_ATTR void mix_columns(const MixedRow& row, int first, int end, std::span<Rgb8> out) {
  const Words d;
  alignas(64) std::uint32_t colors[2 * kLanes];
  for (int x = first; x < end; x += kLanes) {
    const W to_left = hn::LoadU(d, row.joined + x - 1), to_right = hn::LoadU(d, row.joined + x);
    const auto sides = [&](const std::uint32_t* values, W& left, W& right) HWY_ATTR {
      const W here = hn::LoadU(d, values + x);
      left = three_and_one(here, choose(to_left, hn::LoadU(d, values + x - 1), here));
      right = three_and_one(here, choose(to_right, hn::LoadU(d, values + x + 1), here));
    };
    W left_red_blue, right_red_blue, left_green, right_green;
    sides(row.red_blue, left_red_blue, right_red_blue);
    sides(row.green, left_green, right_green);
    hn::StoreInterleaved2(rounded(left_red_blue, left_green), rounded(right_red_blue, right_green),
                          d, colors);
    const auto rest = out.subspan(2 * static_cast<std::size_t>(x));
    write(colors, 2 * std::min(kLanes, end - x), static_cast<int>(rest.size()), rest.data());
  }
}

}  // namespace macula::reprojection::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::reprojection {

HWY_EXPORT(join_columns);
HWY_EXPORT(mix_rows);
HWY_EXPORT(mix_columns);

void DoubledColors::begin(int width) {
  width_ = width;
  const auto room = static_cast<std::size_t>(width + 2 * kAround);
  for (std::vector<std::uint32_t>& row : words_) row.resize(room);
  for (std::vector<std::uint32_t>* row : {&joined_, &red_blue_, &green_}) row->resize(room);
  rows_.fill(kNone);
  joined_row_ = kNone;
}

const std::uint32_t* DoubledColors::words(const Fragments& fragments, const Resolver& resolver,
                                          int row) {
  const std::size_t slot = static_cast<std::size_t>(row) % kKept;
  if (rows_[slot] != row) resolver.resolve_words(fragments.row(row), width_, words_[slot].data());
  rows_[slot] = row;
  return words_[slot].data();
}

void DoubledColors::join(const Fragments& fragments, int row) {
  if (joined_row_ == row) return;
  std::uint32_t* const joined = joined_.data() + kAround;
  HWY_DYNAMIC_DISPATCH(join_columns)(fragments.row(row), width_, joined);
  joined[-1] = joined[width_ - 1] = 0;
  joined_row_ = row;
}

void DoubledColors::draw(const Fragments& fragments, const Resolver& resolver, int y, int first,
                         int end, std::span<Rgb8> out) {
  const int here = y / 2, beside = fragments.row_beside(y);
  const ColoredRow far{words(fragments, resolver, beside), fragments.row(beside)};
  const ColoredRow near{words(fragments, resolver, here), fragments.row(here)};
  join(fragments, here);
  const MixedRow mixed{red_blue_.data() + kAround, green_.data() + kAround,
                       joined_.data() + kAround};
  HWY_DYNAMIC_DISPATCH(mix_rows)
  (near, far, std::max(first - 1, 0), std::min(end + 1, width_), mixed);
  HWY_DYNAMIC_DISPATCH(mix_columns)(mixed, first, end, out);
}

}  // namespace macula::reprojection
#endif  // HWY_ONCE
