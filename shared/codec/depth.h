// Depth travels as inverse depth: 1/z is affine in screen space on planes, and a warp's parallax
// error is f |t| d(1/z). 16-bit samples of scale / 65535 each, left-delta, zig-zag, byte split,
// zstd. The residual says, per 8x8 block, the largest |decoded - true| inverse depth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/base/result.h"
#include "shared/image/plane.h"

namespace macula::codec {

inline constexpr int kDepthBlockPx = 8;

struct DepthOptions {
  float nearest_m = 0.05F;  ///< nearer points clamp here; the residual still tells the truth
  /// One sample, of the middle, for every divisor x divisor cells: 1, 2, 4 or 8. The cells between
  /// are interpolated within a surface and take the nearest sample across an edge of depth.
  int divisor = 1;
  enum class Residual { No, Yes };
  Residual residual = Residual::Yes;  ///< never stated where divisor is above 1
};

struct EncodedDepth {
  std::vector<std::byte> bytes;
  float inverse_scale_per_m = 0.0F;  ///< inverse depth of sample 65535; 0: nothing anywhere
  /// ceil(w/8) x ceil(h/8) blocks of kDepthBlockPx, row by row, in units of inverse_scale_per_m /
  /// 65535 / 16, rounded up; 255 = that or more. Empty: not stated.
  std::vector<std::uint8_t> residual;
};

/// What one unit of EncodedDepth::residual means, 1/m.
inline float residual_step_per_m(float inverse_scale_per_m) {
  return inverse_scale_per_m / 65535.0F / 16.0F;
}

/// View depth in meters (+infinity = nothing there, becomes inverse depth 0 exactly) -> bytes.
/// NaN counts as nothing there. Depth that is not positive clamps to nearest_m like what is too
/// near, and its block states 255. A finite depth becomes 0 only when its inverse is below half a
/// step, that is beyond 131070 times the frame's nearest depth. An Error for a plane that is empty
/// or wider or higher than 65535, a nearest_m outside [1e-6, 1e6] or another divisor.
Result<EncodedDepth> encode_depth(const image::Plane<float>& depth_m,
                                  const DepthOptions& options = {});
/// Bytes -> inverse depth in 1/m; `inverse_depth` must already have its size, from which and from
/// the bytes the divisor follows. An Error when the
/// bytes are damaged or belong to another size; the plane's contents are then unspecified.
Result<void> decode_depth(std::span<const std::byte> bytes, float inverse_scale_per_m,
                          image::Plane<float>& inverse_depth);

}  // namespace macula::codec
