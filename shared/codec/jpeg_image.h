// A whole JPEG picture from memory, as scene files carry them. The header is read and held against
// the limit before anything is allocated. Grey and colour; CMYK is refused.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "shared/base/result.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::codec {

/// `name` is for the error message. A picture that ends early is an error, not half grey.
Result<image::Plane<Rgb8>> decode_jpeg_image(std::span<const std::byte> bytes,
                                             const std::string& name, int max_side_px = 16384);

}  // namespace macula::codec
