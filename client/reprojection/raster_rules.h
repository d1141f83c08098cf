// What every way of drawing holds to. Internal to this room.
#pragma once

namespace macula::reprojection {

/// Triangles grow by this share of themselves, so that rounding opens no cracks between neighbours;
/// where both cover a pixel their values agree. 1e-3 of a cell is far below what can be seen.
inline constexpr float kGrow = 1e-3F;
/// And by this much at least, in pixels.
inline constexpr float kGrow_px = 1e-4F;
/// Rows of the second layer count from here: more than a grid has, and few enough for v, a float,
/// to tell a five-hundredth of a cell.
inline constexpr int kSecondLayerRow = 1 << 14;
/// Smaller triangles are left out: the reciprocal of the area would carry only rounding.
inline constexpr float kLeastArea_px2 = 1e-8F;

}  // namespace macula::reprojection
