#include "shared/codec/hidden_layer.h"

#include <limits>

#include "shared/codec/tiles.h"

namespace macula::codec {
namespace {

/// The layer's depth in its place, whole tiles at a time; elsewhere nothing is there.
image::Plane<float> spread_depth(const Tiles& tiles, const Mask& atlas_mask, const Mask& mask,
                                 const image::Plane<float>& depth_m) {
  image::Plane<float> atlas = tiles.packed(depth_m);
  fill_tiles(atlas_mask, atlas);
  image::Plane<float> whole(mask.width(), mask.height(), std::numeric_limits<float>::infinity());
  tiles.unpack(atlas, whole);
  return whole;
}

}  // namespace

image::Rect atlas_rect(const Mask& mask) {
  const Tiles tiles(mask);
  return {0, 0, tiles.width(), tiles.height()};
}

Result<EncodedHiddenLayer> encode_hidden_layer(const Mask& mask, const image::Plane<Rgb8>& color,
                                               const image::Plane<float>& depth_m,
                                               const ColorOptions& options) {
  const Tiles tiles(mask);
  const Mask atlas_mask = tiles.packed(mask);
  image::Plane<Rgb8> atlas = tiles.packed(color);
  fill_tiles(atlas_mask, atlas);
  auto coded = encode_color(atlas, atlas.rect(), options);
  if (!coded) return base::forward(coded);
  DepthOptions depth_options;
  depth_options.divisor = kHiddenDepthDivisor;
  auto depth = encode_depth(spread_depth(tiles, atlas_mask, mask, depth_m), depth_options);
  if (!depth) return base::forward(depth);
  return EncodedHiddenLayer{encode_mask(mask), std::move(*coded), std::move(*depth)};
}

void unpack_atlas(const Mask& mask, const image::Plane<Rgb8>& atlas, image::Plane<Rgb8>& color) {
  Tiles(mask).unpack(atlas, color);
}

}  // namespace macula::codec
