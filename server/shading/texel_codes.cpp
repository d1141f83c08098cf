#include "server/shading/texel_codes.h"

#include "shared/image/tone.h"

namespace macula::shading {

const TexelCodes& TexelCodes::of(scene::ColorSpace space) {
  static const TexelCodes srgb(image::linear_from_srgb);
  static const TexelCodes linear([](float code) { return code; });
  return space == scene::ColorSpace::Srgb ? srgb : linear;
}

TexelCodes::TexelCodes(float (*decode)(float)) {
  for (std::size_t code = 0; code < decoded_.size(); ++code) {
    decoded_[code] = decode(static_cast<float>(code) / 255.0F);
  }
  for (std::size_t code = 0; code < borders_.size(); ++code) {
    borders_[code] = decode((static_cast<float>(code) + 0.5F) / 255.0F);
  }
  std::size_t code = 0;
  for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) {
    const float lowest = static_cast<float>(bucket) / kBuckets;
    while (code < borders_.size() && borders_[code] <= lowest) ++code;
    least_[bucket] = static_cast<std::uint8_t>(code);
  }
}

/// A bucket spans less than one code where sRGB is steepest (12.92 x 255 / 4096): one or two steps.
std::uint8_t TexelCodes::encode(float linear) const {
  if (!(linear > 0.0F)) return 0;
  if (linear >= 1.0F) return 255;
  std::size_t code = least_[static_cast<std::size_t>(linear * kBuckets)];
  while (code < borders_.size() && borders_[code] <= linear) ++code;
  return static_cast<std::uint8_t>(code);
}

}  // namespace macula::shading
