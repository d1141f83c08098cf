// An encoded picture of a scene file -> RGBA, PNG or JPEG, within a limit on its sides. The format
// is told by the first bytes: file names and MIME types lie.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "server/scene/scene.h"
#include "shared/base/result.h"

namespace macula::scene {

inline constexpr int kMaxImageSide = 8192;
inline constexpr std::uint64_t kMaxImagePixels = std::uint64_t{1} << 29;  ///< over a scene

/// `place` is for the error message.
Result<image::Plane<image::Rgba8>> decode_image(std::span<const std::byte> bytes,
                                                const std::string& place);

}  // namespace macula::scene
