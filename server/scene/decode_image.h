// ImageDecoder: the encoded pictures of one scene file -> RGBA, PNG or JPEG, within limits on their
// sides and on their sum. The format is told by the first bytes: file names and MIME types lie.
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

/// Pixels that a scene may have for nothing, and for each byte of its encoded pictures beyond them:
/// a few hundred kilobytes of PNG can hold gigabytes of one colour.
inline constexpr std::uint64_t kFreeImagePixels = std::uint64_t{1} << 25;
inline constexpr std::uint64_t kImagePixelsPerByte = 64;

class ImageDecoder {
 public:
  /// `place` is for the error message.
  Result<image::Plane<image::Rgba8>> decode(std::span<const std::byte> bytes,
                                            const std::string& place);

 private:
  std::uint64_t pixels_ = 0, bytes_ = 0;  ///< so far
};

}  // namespace macula::scene
