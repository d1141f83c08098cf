// Swapchain: one eye's row of textures that the runtime lends for drawing, of colour or of depth.
// Internal to this room.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "client/display/gl/picture_space.h"
#include "client/display/openxr/openxr.h"
#include "shared/base/result.h"

namespace macula::display {

class Swapchain {
 public:
  enum class Kind { Color, Depth };
  /// Colour: 8 bits of sRGB; depth: 32-bit float, or 24 or 16 bits. Errors: the runtime offers
  /// neither, or makes no swapchain.
  static Result<std::unique_ptr<Swapchain>> create(XrSession session, Kind kind, PictureSize size);
  ~Swapchain();
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;

  /// The texture to fill now; nullopt where the runtime lends none. release() gives it back.
  std::optional<unsigned> acquire();
  void release();
  XrSwapchainSubImage whole() const;

 private:
  Swapchain(XrSwapchain swapchain, PictureSize size) : swapchain_(swapchain), size_(size) {}
  Result<void> find_textures();

  XrSwapchain swapchain_;
  PictureSize size_;
  std::vector<unsigned> textures_;
};

}  // namespace macula::display
