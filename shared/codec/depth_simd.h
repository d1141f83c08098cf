// The loop of encode_depth that divides: depth -> 16-bit samples and what they lose, a row at a
// time, in vectors. Internal to this room. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

namespace macula::codec {

inline constexpr float kNothingThere = std::numeric_limits<float>::infinity();
inline constexpr float kLastSample = 65535.0F;

/// Samples <-> inverse depth, for one frame. A scale of 0 means that nothing is there at all.
struct Quantizer {
  explicit Quantizer(float inverse_scale_per_m)
      : step_per_m(inverse_scale_per_m / kLastSample),
        steps_m(inverse_scale_per_m > 0.0F ? kLastSample / inverse_scale_per_m : 0.0F) {}
  /// In 1/m; the encoder's residual is against exactly this.
  float inverse(std::uint16_t sample) const { return static_cast<float>(sample) * step_per_m; }

  float step_per_m;  ///< inverse depth of one step
  float steps_m;     ///< steps per inverse depth
};

/// Rows handed to quantize_row are this many elements longer than their plane is wide, at most, so
/// that they consist of whole vectors.
inline constexpr std::size_t kRowPadding = 64;

/// `depth_m`, `samples` and `error_per_m` each have room for width + kRowPadding; the padding of
/// depth must be set (kNothingThere). Raises `error_per_m`, per column, to at least |decoded -
/// true|; it is infinite where depth is not positive.
void quantize_row(const float* depth_m, std::size_t width, const Quantizer& quantizer,
                  float nearest_m, std::uint16_t* samples, float* error_per_m);

}  // namespace macula::codec
