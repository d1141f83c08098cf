#include "shared/image/tone.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/image/tone_simd.h"

namespace macula::image {
namespace {

double srgb_from_linear_exact(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

double linear_from_srgb_exact(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

/// [0, 1]; NaN becomes 0.
double clamp_unit(float value) {
  return value > 0.0F ? std::min(double{value}, 1.0) : 0.0;
}

/// The smallest float that `code` begins at.
float first_linear_of(int code) {
  const double boundary = linear_from_srgb_exact((code - 0.5) / 255.0);
  const auto nearest = static_cast<float>(boundary);
  return nearest < boundary ? std::nextafter(nearest, 2.0F) : nearest;
}

/// Narkowicz, "ACES Filmic Tone Mapping Curve" (2015). Rises from 0 to 2.51 / 2.43, hence the
/// clamp.
float filmic(float x) {
  const float mapped = (x * (2.51F * x + 0.03F)) / (x * (2.43F * x + 0.59F) + 0.14F);
  return std::min(mapped, 1.0F);
}

float gain_of(const Tone& tone) {
  return std::exp2(tone.exposure_ev);
}

}  // namespace

SrgbTable::SrgbTable() {
  int code = 0;
  for (std::uint32_t bucket = 0; bucket < kBuckets; ++bucket) {
    auto& entry = entries_[bucket];
    const std::uint32_t bucket_bits = (bucket + kFirstBucket) << 16;
    entry = static_cast<std::uint32_t>(code) << 16;
    if (code == 255) continue;
    const auto boundary = std::bit_cast<std::uint32_t>(first_linear_of(code + 1));
    if (boundary > (bucket_bits | 0xFFFFU)) continue;
    MACULA_CHECK(boundary >= bucket_bits, "two codes begin in one bucket");
    entry += 0x10000U - (boundary & 0xFFFFU);
    ++code;
  }
  MACULA_CHECK(code == 255, "the table ends before white");
}

const SrgbTable& SrgbTable::instance() {
  static const SrgbTable table;
  return table;
}

float display_linear_channel(float gain, ToneCurve curve, float radiance) {
  if (!std::isfinite(radiance)) return 0.0F;
  float exposed = radiance * gain;
  if (!(exposed > 0.0F)) return 0.0F;
  exposed = std::min(exposed, kBrightestExposed);
  return curve == ToneCurve::Filmic ? filmic(exposed) : std::min(exposed, 1.0F);
}

float srgb_from_linear(float linear) {
  return static_cast<float>(srgb_from_linear_exact(clamp_unit(linear)));
}

float linear_from_srgb(float srgb) {
  return static_cast<float>(linear_from_srgb_exact(clamp_unit(srgb)));
}

Rgb display_linear(const Tone& tone, const Rgb& radiance) {
  const float gain = gain_of(tone);
  return {display_linear_channel(gain, tone.curve, radiance.x),
          display_linear_channel(gain, tone.curve, radiance.y),
          display_linear_channel(gain, tone.curve, radiance.z)};
}

Rgb8 encode(const Tone& tone, const Rgb& radiance) {
  const Rgb shown = display_linear(tone, radiance);
  const SrgbTable& table = SrgbTable::instance();
  return {table.code(shown.x), table.code(shown.y), table.code(shown.z)};
}

void encode(const Tone& tone, const Plane<Rgb>& radiance, Plane<Rgb8>& out) {
  static_assert(sizeof(Rgb) == 3 * sizeof(float), "a plane of radiance is a run of channels");
  if (out.width() != radiance.width() || out.height() != radiance.height())
    out.resize(radiance.width(), radiance.height());
  if (radiance.empty()) return;
  const std::size_t channels = 3 * radiance.size();
  encode_channels(gain_of(tone), tone.curve, {&radiance.data()->x, channels},
                  {&out.data()->r, channels});
}

Plane<Rgb> decode_display_linear(const Plane<Rgb8>& encoded) {
  static const auto kLinear = [] {
    std::array<float, 256> linear{};
    for (std::size_t code = 0; code < linear.size(); ++code)
      linear[code] = static_cast<float>(linear_from_srgb_exact(static_cast<double>(code) / 255.0));
    return linear;
  }();
  Plane<Rgb> out(encoded.width(), encoded.height());
  std::transform(encoded.pixels().begin(), encoded.pixels().end(), out.pixels().begin(),
                 [](Rgb8 c) {
                   return Rgb{kLinear[c.r], kLinear[c.g], kLinear[c.b]};
                 });
  return out;
}

}  // namespace macula::image
