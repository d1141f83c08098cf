#include "shared/image/tone_simd.h"

#include "shared/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shared/image/tone_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace macula::image::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using FloatVec = hn::Vec<Floats>;

// Every step is the scalar's, operation by operation and never fused, so that the bits agree.

HWY_INLINE HWY_ATTR FloatVec exposed_channels(FloatVec radiance, FloatVec gain) {
  const Floats d;
  const auto finite = hn::IfThenElseZero(hn::IsFinite(radiance), radiance);
  const auto exposed = hn::Mul(finite, gain);
  const auto lit = hn::IfThenElseZero(hn::Gt(exposed, hn::Zero(d)), exposed);
  return hn::Min(lit, hn::Set(d, kBrightestExposed));
}

HWY_INLINE HWY_ATTR FloatVec filmic(FloatVec x) {
  const Floats d;
  const auto over = hn::Mul(x, hn::Add(hn::Mul(hn::Set(d, 2.51F), x), hn::Set(d, 0.03F)));
  const auto under = hn::Mul(x, hn::Add(hn::Mul(hn::Set(d, 2.43F), x), hn::Set(d, 0.59F)));
  return hn::Div(over, hn::Add(under, hn::Set(d, 0.14F)));
}

HWY_INLINE HWY_ATTR void store_codes(FloatVec linear, const std::int32_t* table,
                                     std::uint8_t* codes) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  const hn::Rebind<std::uint8_t, Floats> du8;
  const auto in_range =
      hn::Min(hn::Max(linear, hn::Set(d, SrgbTable::kDarkest)), hn::Set(d, SrgbTable::kBrightest));
  const auto bits = hn::BitCast(di, in_range);
  const auto bucket = hn::Sub(hn::ShiftRight<16>(bits),
                              hn::Set(di, static_cast<std::int32_t>(SrgbTable::kFirstBucket)));
  const auto entry = hn::GatherIndex(di, table, bucket);
  const auto code =
      hn::ShiftRight<16>(hn::Add(entry, hn::And(bits, hn::Set(di, std::int32_t{0xFFFF}))));
  hn::StoreU(hn::DemoteTo(du8, code), du8, codes);
}

template <ToneCurve kCurve>
HWY_ATTR std::size_t encode_whole_vectors(float gain, std::span<const float> radiance,
                                          std::uint8_t* codes) {
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  const std::int32_t* table = SrgbTable::instance().data();
  const auto gains = hn::Set(d, gain);
  std::size_t i = 0;
  for (; i + lanes <= radiance.size(); i += lanes) {
    const auto exposed = exposed_channels(hn::LoadU(d, radiance.data() + i), gains);
    if constexpr (kCurve == ToneCurve::Filmic)
      store_codes(filmic(exposed), table, codes + i);
    else
      store_codes(exposed, table, codes + i);
  }
  return i;
}

HWY_ATTR std::size_t encode_vectors(float gain, ToneCurve curve, std::span<const float> radiance,
                                    std::uint8_t* codes) {
  return curve == ToneCurve::Filmic
             ? encode_whole_vectors<ToneCurve::Filmic>(gain, radiance, codes)
             : encode_whole_vectors<ToneCurve::Linear>(gain, radiance, codes);
}

}  // namespace macula::image::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::image {

HWY_EXPORT(encode_vectors);

void encode_channels(float gain, ToneCurve curve, std::span<const float> radiance,
                     std::span<std::uint8_t> codes) {
  MACULA_CHECK(codes.size() == radiance.size());
  const SrgbTable& table = SrgbTable::instance();
  std::size_t i = HWY_DYNAMIC_DISPATCH(encode_vectors)(gain, curve, radiance, codes.data());
  for (; i < radiance.size(); ++i)
    codes[i] = table.code(display_linear_channel(gain, curve, radiance[i]));
}

}  // namespace macula::image
#endif
