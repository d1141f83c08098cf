// Where pictures stand in the window: side by side, as large as fits, aspect kept, centred.
// Rectangles are in framebuffer pixels, origin top left.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "client/display/window/input.h"
#include "shared/image/plane.h"

namespace macula::display {

/// One rectangle a picture, all at one scale; at scale 1 pixels map to pixels. Pictures without
/// pixels and windows without room get empty rectangles.
std::vector<image::Rect> place_side_by_side(std::span<const PictureSize> pictures,
                                            PictureSize framebuffer);

/// The picture that covers a framebuffer position, and where in it.
std::optional<PictureTarget> picture_at(std::span<const image::Rect> places, float x_px,
                                        float y_px);

}  // namespace macula::display
