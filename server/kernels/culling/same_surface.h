// Whether cells of a view lie on one surface, so that they may share their light.
#pragma once

#include "server/kernels/kernel.h"

namespace macula::kernels::culling {

using image::Pixel;
using image::Plane;

class SameSurface {
 public:
  /// Refers to the buffers' depth and normals.
  SameSurface(const View& view, const ViewBuffers& buffers);

  /// Both are hit, normals within 25 degrees, `to` within 2 % of the depth off the plane at `from`.
  bool operator()(const Pixel& from, const Pixel& to) const;

 private:
  const ViewBuffers& buffers_;
  Plane<Vec3> place_;  ///< relative to the eye, world orientation, meters
};

}  // namespace macula::kernels::culling
