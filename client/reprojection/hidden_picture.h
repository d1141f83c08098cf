// HiddenPicture: a frame's second layer as the warp draws it. The cells that something hides take
// what they hide, all others stay as the first layer has them: so both layers hang together where
// the hidden surface comes out into the open, and only cells around hidden ones need drawing. Made
// once a frame, immutable afterwards.
#pragma once

#include <cstdint>

#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::reprojection {

struct HiddenPicture {
  image::Plane<Rgb8> color;                 ///< of the grid's size
  image::Plane<float> inverse_depth_per_m;  ///< of the grid's size; as SourceView's
  /// (width + 1) x (height + 1): 1 where the mesh's cell between vertices (x, y) and (x + 1, y + 1)
  /// has a corner that hides something, else 0.
  image::Plane<std::uint8_t> cells;
};

/// `band`: 1 where the layer has something to say. All planes have the grid's size; `hidden_*` are
/// read only inside the band.
HiddenPicture make_hidden_picture(const image::Plane<Rgb8>& color,
                                  const image::Plane<float>& inverse_depth_per_m,
                                  const image::Plane<std::uint8_t>& band,
                                  const image::Plane<Rgb8>& hidden_color,
                                  const image::Plane<float>& hidden_inverse_depth_per_m);

}  // namespace macula::reprojection
