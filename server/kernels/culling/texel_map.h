// Where a view's indirect light is asked: a picture of its own, smaller than the view, whose texels
// stand for cells of it. Log-polar (section 3.5 of the paper; Meng et al., "Kernel Foveated
// Rendering", 2018): rings about the gaze, dense there. Thinned: every n-th cell. Pure; immutable.
#pragma once

#include <vector>

#include "server/kernels/kernel.h"

namespace macula::kernels::culling {

using image::Pixel;
using image::Plane;

class TexelMap {
 public:
  /// Every n-th cell each way, n >= 1.
  static TexelMap thinned(const PixelGrid& grid, int n);
  /// u = W K^-1(ln r / L), v = H (angle / 2 pi), with r >= 1 the distance from the gaze in cells, L
  /// the logarithm of the largest, K(x) = x^power, and W x H the grid's size over `shrink` >= 1.
  static TexelMap log_polar(const PixelGrid& grid, const Gaze& gaze, double shrink, double power);

  int width() const { return cell_.width(); }
  int height() const { return cell_.height(); }
  /// The cell that is asked for a texel.
  Pixel cell(int u, int v) const { return cell_(u, v); }
  /// Where a cell's middle lies among the texels; texel (i, j) has its own middle at (i + 0.5, j +
  /// 0.5).
  Vec2 place(int x, int y) const;
  /// Columns or rows beyond the last are the first ones again: angles.
  bool wraps() const { return log_polar_; }

 private:
  Plane<Pixel> cell_;
  bool log_polar_ = false;
  float step_ = 1.0F;  ///< thinned: cells a texel
  Vec2 gaze_{0.0F};    ///< log-polar: in cells
  float log_largest_ = 1.0F, power_ = 1.0F;
};

}  // namespace macula::kernels::culling
