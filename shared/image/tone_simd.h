// Display-linear floats -> sRGB bytes, exactly rounded, by one table look-up on the bits of the
// float: code k begins at the smallest float whose sRGB value is at least (k - 0.5) / 255. Internal
// to this room; tone.h is the door. Everything here is thread-safe.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/image/tone.h"

namespace macula::image {

/// A bucket is one value of the float's upper 16 bits (exponent and 7 bits of mantissa); between
/// kDarkest and 1 no bucket holds more than one boundary between codes. An entry is arranged so
/// that adding the float's lower 16 bits carries into bit 16 exactly from the boundary on:
///   code(x) = (entry[x >> 16] + (x & 0xFFFF)) >> 16.
class SrgbTable {
 public:
  static constexpr float kDarkest = 0x1p-13F;          ///< below code 1, which begins at 1.52e-4
  static constexpr float kBrightest = 0x1.fffffep-1F;  ///< the last float below 1
  static constexpr std::uint32_t kFirstBucket = std::bit_cast<std::uint32_t>(kDarkest) >> 16;
  static constexpr std::uint32_t kBuckets =
      (std::bit_cast<std::uint32_t>(kBrightest) >> 16) - kFirstBucket + 1;

  static const SrgbTable& instance();

  /// NaN is 0.
  std::uint8_t code(float linear) const {
    if (!(linear > kDarkest)) return 0;
    const auto bits = std::bit_cast<std::uint32_t>(linear < kBrightest ? linear : kBrightest);
    const std::uint32_t entry = entries_[(bits >> 16) - kFirstBucket];
    return static_cast<std::uint8_t>((entry + (bits & 0xFFFFU)) >> 16);
  }
  const std::int32_t* data() const {
    return reinterpret_cast<const std::int32_t*>(entries_.data());
  }

 private:
  SrgbTable();

  std::array<std::uint32_t, kBuckets> entries_{};
};

/// Above this the curves have long reached white; it keeps inf / inf out of them.
inline constexpr float kBrightestExposed = 1e6F;

/// encode() for a run of channels: `codes` has as many as `radiance`. `gain` is 2^exposure_ev.
void encode_channels(float gain, ToneCurve curve, std::span<const float> radiance,
                     std::span<std::uint8_t> codes);
/// One channel; encode_channels gives the same bits.
float display_linear_channel(float gain, ToneCurve curve, float radiance);

}  // namespace macula::image
