// PNG in and out. Reading limits the size before allocating (<= 16384 a side by default) and accepts
// 8/16-bit grey, palette, RGB, with or without alpha; alpha is returned separately.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "shared/base/result.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::image {

struct Rgba8 {
  std::uint8_t r = 0, g = 0, b = 0, a = 255;
};

Result<void> write_png(const std::string& path, const Plane<Rgb8>& picture);
Result<Plane<Rgb8>> read_png(const std::string& path, int max_side_px = 16384);
/// From memory, as scene files embed them; `name` is for the error message.
Result<Plane<Rgba8>> decode_png(std::span<const std::byte> bytes, const std::string& name,
                                int max_side_px = 16384);

}  // namespace macula::image
