// ErrorBound: how far from its true place, in display pixels, the warp may show a point of a
// surface that the frame saw. A colour stands for all points of its cell, at the depth the frame
// says for the cell's centre; so the bound is the way from the centre to the cell's farthest corner
// (resampling), and the parallax of all that is not known of the depth there: the residual that the
// frame states for its block of 8x8 cells, and the steps to the cells around, three to every side,
// where another surface may begin or one show that is thinner than a cell. What is guessed or
// hidden, and things that move, are not in it: Coverage tells the guesses. What shows at no cell's
// centre there is beyond what a frame knows: a few of a million points, slits and wires.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/reprojection/warp.h"

namespace macula::reprojection {

/// What a frame says of its own depth: the largest |stated - true| inverse depth of each block of
/// 8x8 cells, row by row, in steps of `step_per_m`; 255 = that or more.
struct DepthResidual {
  std::span<const std::uint8_t> blocks;
  float step_per_m = 0.0F;
};

/// How well the display's pose is known.
struct PoseDoubt {
  double position_m = 0.0;
  Radians turn{0.0};
};

class ErrorBound {
 public:
  /// `residual`: of the source's grid; without blocks depth is taken as exact. Refers to `source`.
  ErrorBound(const SourceView& source, const DepthResidual& residual,
             const Pose& stage_from_display, const foveation::Display& display,
             const WarpOptions& options, const PoseDoubt& doubt = {});

  /// Display pixels, of every point within the cell; infinite where the residual is not bounded or
  /// the cell comes within its doubt of the display's eye.
  double at(int x, int y) const;
  /// Where the warp shows the point at (fx, fy) in [0, 1]^2 of a cell at `inverse_depth` (1/m):
  /// display pixels from the corner of the picture; NaN where it is not in front of the eye.
  DVec2 place(int x, int y, double fx, double fy, double inverse_depth) const;

  /// Over the part of the frame that the display shows, weighted by what cells cover there; from
  /// every fourth cell of every fourth row.
  struct Summary {
    double p50_px = 0.0, p95_px = 0.0, most_px = 0.0;
  };
  Summary summarise() const;

 private:
  double depth_doubt(int x, int y) const;
  double parallax_px(const DVec3& point, double doubt) const;

  const SourceView& source_;
  const DepthResidual residual_;
  const foveation::Display& display_;
  DMat3 rotation_;
  DVec3 offset_m_;
  DVec2 pixels_per_tangent_, tangent_min_;
  double drawn_px_;  ///< blocks of cells may be drawn so far from where their cells belong
  PoseDoubt doubt_;
};

}  // namespace macula::reprojection
