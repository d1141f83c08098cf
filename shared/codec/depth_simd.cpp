#include "shared/codec/depth_simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shared/codec/depth_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace macula::codec::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kRowPadding>;
using FloatVec = hn::Vec<Floats>;

/// 1 / z in float is within 2^-24 of the truth; twice that also covers the subtraction before it.
constexpr float kInverseMargin = 0x1p-23F;

/// Inverse depth as it truly is; what is not in front of the viewer is infinitely far from right.
HWY_INLINE HWY_ATTR FloatVec true_inverse(FloatVec depth) {
  const Floats d;
  const auto inverse = hn::Div(hn::Set(d, 1.0F), depth);
  return hn::IfThenElse(hn::Le(depth, hn::Zero(d)), hn::Set(d, kNothingThere), inverse);
}

HWY_INLINE HWY_ATTR hn::VFromD<hn::RebindToSigned<Floats>> quantize(FloatVec inverse,
                                                                    FloatVec steps) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  const auto scaled = hn::Add(hn::Mul(inverse, steps), hn::Set(d, 0.5F));
  return hn::ConvertTo(di, hn::Min(scaled, hn::Set(d, kLastSample)));
}

HWY_ATTR void quantize_vectors(const float* depth_m, std::size_t width, const Quantizer& quantizer,
                               float nearest_m, std::uint16_t* samples, float* error_per_m) {
  const Floats d;
  const hn::Rebind<std::uint16_t, Floats> du16;
  const auto steps = hn::Set(d, quantizer.steps_m), step = hn::Set(d, quantizer.step_per_m);
  for (std::size_t x = 0; x < width; x += hn::Lanes(d)) {
    const auto given = hn::LoadU(d, depth_m + x);
    const auto depth = hn::IfThenElse(hn::IsNaN(given), hn::Set(d, kNothingThere), given);
    const auto clamped = hn::Max(depth, hn::Set(d, nearest_m));
    const auto sample = quantize(hn::Div(hn::Set(d, 1.0F), clamped), steps);
    const auto truth = true_inverse(depth);
    const auto decoded = hn::Mul(hn::ConvertTo(d, sample), step);
    const auto lost =
        hn::Add(hn::Abs(hn::Sub(decoded, truth)), hn::Mul(truth, hn::Set(d, kInverseMargin)));
    hn::StoreU(hn::DemoteTo(du16, sample), du16, samples + x);
    hn::StoreU(hn::Max(hn::LoadU(d, error_per_m + x), lost), d, error_per_m + x);
  }
}

}  // namespace macula::codec::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::codec {

HWY_EXPORT(quantize_vectors);

void quantize_row(const float* depth_m, std::size_t width, const Quantizer& quantizer,
                  float nearest_m, std::uint16_t* samples, float* error_per_m) {
  HWY_DYNAMIC_DISPATCH(quantize_vectors)
  (depth_m, width, quantizer, nearest_m, samples, error_per_m);
}

}  // namespace macula::codec
#endif
