#include "server/kernels/ray/mask_row.h"

#include <array>

#include "server/sampling/blue_noise.h"
#include "shared/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/kernels/ray/mask_row_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace macula::kernels::ray::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class D>
HWY_INLINE HWY_ATTR void probabilities_at(D d, const ProbabilityRow& row, std::size_t i,
                                          float* out) {
  const hn::RebindToSigned<D> di;
  const auto one = hn::Set(d, 1.0F), half = hn::Set(d, 0.5F), zero = hn::Zero(d);
  const auto tx = hn::LoadU(d, row.tangent_x.data() + i);
  const auto ahead =
      hn::MulAdd(tx, hn::Set(d, row.gaze.x), hn::Set(d, -row.gaze.y * row.tangent_y - row.gaze.z));
  const auto squared = hn::MulAdd(tx, tx, hn::Set(d, row.tangent_y * row.tangent_y + 1.0F));
  const auto cosine = hn::Div(ahead, hn::Sqrt(squared));
  const auto sine2 = hn::Min(hn::Max(hn::NegMulAdd(half, cosine, half), zero), one);
  const auto steps = hn::Set(d, static_cast<float>(row.rates.size() - 1));
  const auto index = hn::ConvertTo(di, hn::Mul(hn::Sqrt(sine2), steps));
  const auto rate = hn::GatherIndex(d, row.rates.data(), index);
  const auto area = hn::Max(
      hn::Mul(hn::LoadU(d, row.cell_width.data() + i), hn::Set(d, row.area_per_width)), zero);
  // A cell of nominal size is 1 to rounding: as full as it can be.
  const auto nominal = hn::Lt(hn::Abs(hn::Sub(area, one)), hn::Set(d, 1e-3F));
  hn::StoreU(hn::Min(hn::Mul(rate, hn::IfThenElse(nominal, one, area)), one), d, out + i);
}

HWY_ATTR void fill_probabilities(const ProbabilityRow& row, std::size_t width, float* out) {
  const hn::ScalableTag<float> d;
  const hn::CappedTag<float, 1> d1;
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= width; i += hn::Lanes(d)) probabilities_at(d, row, i, out);
  for (; i < width; ++i) probabilities_at(d1, row, i, out);
}

/// `levels` are the row's thresholds in units of 2^-32, before they move.
template <class D>
HWY_INLINE HWY_ATTR std::size_t compare_at(D d, const float* p, const std::uint32_t* levels,
                                           std::uint32_t moved, std::uint8_t* out) {
  const hn::RebindToUnsigned<D> du;
  const hn::RebindToSigned<D> di;
  const hn::Rebind<std::uint8_t, D> d8;
  const auto level = hn::Add(hn::LoadU(du, levels), hn::Set(du, moved));
  const auto upper = hn::BitCast(di, hn::ShiftRight<8>(level));
  const auto threshold = hn::Mul(hn::ConvertTo(d, upper), hn::Set(d, 0x1p-24F));
  const auto value = hn::LoadU(d, p);
  const auto full = hn::Ge(value, hn::Set(d, 1.0F));
  const auto traced = hn::Or(full, hn::Lt(threshold, value));
  const auto one = hn::Set(di, 1);
  const auto code = hn::Add(hn::IfThenElseZero(hn::RebindMask(di, traced), one),
                            hn::IfThenElseZero(hn::RebindMask(di, full), one));
  hn::StoreU(hn::DemoteTo(d8, code), d8, out);
  return hn::CountTrue(d, traced);
}

HWY_ATTR std::size_t compare_row(const float* p, const std::uint16_t* ranks, std::uint32_t moved,
                                 std::size_t width, std::uint8_t* out) {
  constexpr std::size_t kSide = sampling::BlueNoise::kSide;
  HWY_ALIGN std::uint32_t levels[kSide];
  for (std::size_t i = 0; i < kSide; ++i) {
    levels[i] = (2U * ranks[i] + 1U) * (0x80000000U / sampling::BlueNoise::kCount);
  }
  const hn::ScalableTag<float> d;
  const hn::CappedTag<float, 1> d1;
  std::size_t i = 0, count = 0;
  for (; i + hn::Lanes(d) <= width; i += hn::Lanes(d)) {
    count += compare_at(d, p + i, levels + i % kSide, moved, out + i);
  }
  for (; i < width; ++i) count += compare_at(d1, p + i, levels + i % kSide, moved, out + i);
  return count;
}

}  // namespace macula::kernels::ray::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::kernels::ray {

HWY_EXPORT(fill_probabilities);
HWY_EXPORT(compare_row);

void probabilities(const ProbabilityRow& row, std::span<float> out) {
  MACULA_CHECK(row.tangent_x.size() == out.size() && row.cell_width.size() == out.size());
  HWY_DYNAMIC_DISPATCH(fill_probabilities)(row, out.size(), out.data());
}

std::size_t compare_thresholds(std::span<const float> p, std::span<const std::uint16_t> ranks,
                               std::uint32_t level, std::span<std::uint8_t> out) {
  MACULA_CHECK(ranks.size() == sampling::BlueNoise::kSide && p.size() == out.size());
  return HWY_DYNAMIC_DISPATCH(compare_row)(p.data(), ranks.data(), level, p.size(), out.data());
}

}  // namespace macula::kernels::ray
#endif
