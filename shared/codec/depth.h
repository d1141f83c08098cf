// Depth travels as inverse depth: 1/z is affine in screen space on planes, and a warp's parallax error
// is f |t| d(1/z). 16-bit samples of scale / 65535 each, left-delta, zig-zag, byte split, zstd.
// The residual says, per 8x8 block, the largest |decoded - true| inverse depth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/base/result.h"
#include "shared/image/plane.h"

namespace macula::codec {

struct DepthOptions {
  float nearest_m = 0.05F;  ///< nearer points clamp here; the residual still tells the truth
};

struct EncodedDepth {
  std::vector<std::byte> bytes;
  float inverse_scale_per_m = 0.0F;     ///< inverse depth of sample 65535
  /// ceil(w/8) x ceil(h/8), in units of inverse_scale_per_m / 65535 / 16, rounded up, 255 = or more.
  std::vector<std::uint8_t> residual;
};

/// View depth in meters (+infinity = nothing there, becomes inverse depth 0 exactly) -> bytes.
Result<EncodedDepth> encode_depth(const image::Plane<float>& depth_m, const DepthOptions& options = {});
/// Bytes -> inverse depth in 1/m; `inverse_depth` must already have its size.
Result<void> decode_depth(std::span<const std::byte> bytes, float inverse_scale_per_m,
                          image::Plane<float>& inverse_depth);

}  // namespace macula::codec
