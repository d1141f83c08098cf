// TexelCodes: between stored 8-bit channels and linear values, by tables, in either colour space.
// Immutable and shared; safe from any thread.
#pragma once

#include <array>
#include <cstdint>

#include "server/scene/scene.h"

namespace macula::shading {

class TexelCodes {
 public:
  static const TexelCodes& of(scene::ColorSpace space);

  /// 256 linear values in [0, 1], by code.
  const float* decoded() const { return decoded_.data(); }
  /// The code whose encoded value is nearest; values outside [0, 1] read the nearer end.
  std::uint8_t encode(float linear) const;

 private:
  explicit TexelCodes(float (*decode)(float));

  static constexpr int kBuckets = 4096;
  std::array<float, 256> decoded_{};
  std::array<float, 255> borders_{};  ///< the linear value from which code i + 1 is nearer than i
  std::array<std::uint8_t, kBuckets> least_{};  ///< the least code of a value in each bucket
};

}  // namespace macula::shading
