// What every way of projecting a vertex holds to. Internal to this room.
#pragma once

namespace macula::reprojection {

/// Geometry nearer to the display's eye is left out.
inline constexpr float kNear_m = 0.01F;
/// Least cosine-like component towards the view axis: directions beyond 89.9 degrees have no pixel.
inline constexpr float kLeastForward = 1e-3F;
/// What is nearer to the source's eye counts as being here.
inline constexpr float kNearest_per_m = 1000.0F;

}  // namespace macula::reprojection
