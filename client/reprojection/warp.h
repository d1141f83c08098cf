// The warp: the newest frame, rendered at one pose on its own grid, seen from the display pose now.
// Forward mesh: the grid's cells are the mesh; quads are cut at silhouettes by the actual camera
// offset; what stays open is filled from the farther side and flagged. Pure maths on the CPU: knows no
// GL and no OpenXR. Frames and tangents: shared/math/frames.h.
#pragma once

#include <cstdint>

#include "shared/foveation/pixel_grid.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"
#include "shared/math/pose.h"

namespace macula::reprojection {

/// One eye of a decoded frame. Colour is display-encoded; depth is inverse, 0 = nothing there.
struct SourceView {
  Pose stage_from_view;
  const PixelGrid& grid;
  const image::Plane<Rgb8>& color;
  const image::Plane<float>& inverse_depth_per_m;
};

struct WarpOptions {
  enum class Method { Mesh, RotationOnly, Stale };
  Method method = Method::Mesh;
  /// Cut a quad when its corners drift apart by more than this many display pixels.
  float cut_px = 0.75F;
  enum class Holes { FillFartherSide, LeaveBlack };
  Holes holes = Holes::FillFartherSide;
};

struct WarpReport {
  std::uint64_t covered_px = 0, filled_px = 0, outside_px = 0;
  double filled_share() const {
    const auto all = covered_px + filled_px + outside_px;
    return all == 0 ? 0.0 : static_cast<double>(filled_px) / static_cast<double>(all);
  }
};

enum class Coverage : std::uint8_t { Outside, Covered, Filled };

/// `out` has the display's size; `coverage` may be null. Filtering is linear in display-encoded values.
WarpReport warp(const SourceView& source, const Pose& stage_from_display,
                const foveation::Display& display, const WarpOptions& options,
                image::Plane<Rgb8>& out, image::Plane<Coverage>* coverage = nullptr);

}  // namespace macula::reprojection
