// The second layer of a picture <-> bytes: which cells it has (band_mask), their colours as an
// atlas of tiles in the first layer's own lossy or lossless codec, and their inverse depth, one
// sample for 4 x 4 cells. What decoding gives is unspecified outside the mask. Thread-safe.
#pragma once

#include "shared/codec/band_mask.h"
#include "shared/codec/color.h"
#include "shared/codec/depth.h"

namespace macula::codec {

inline constexpr int kHiddenDepthDivisor = 4;

/// Of JPEG, where the first layer has `quality`: the second one is seen for a moment and beside
/// what the eye looks at.
constexpr int hidden_jpeg_quality(int quality) {
  return quality > 25 ? quality - 15 : 10;
}

struct EncodedHiddenLayer {
  std::vector<std::byte> mask, color;
  EncodedDepth depth;
  std::size_t bytes() const { return mask.size() + color.size() + depth.bytes.size(); }
};
struct HiddenLayerPlanes {
  Mask mask;
  image::Plane<Rgb8> color;
  image::Plane<float> inverse_depth_per_m;
};

/// Size of the atlas of a mask's tiles, in cells; 0 x 0 for an empty one.
image::Rect atlas_rect(const Mask& mask);

/// Colour and view depth (meters, +infinity = nothing there) of the mask's size; only what lies in
/// the mask is read. The mask holds something. Errors: encode_color's and encode_depth's.
Result<EncodedHiddenLayer> encode_hidden_layer(const Mask& mask, const image::Plane<Rgb8>& color,
                                               const image::Plane<float>& depth_m,
                                               const ColorOptions& options);

/// The atlas, decoded -> the colours of the mask's cells.
void unpack_atlas(const Mask& mask, const image::Plane<Rgb8>& atlas, image::Plane<Rgb8>& color);

}  // namespace macula::codec
