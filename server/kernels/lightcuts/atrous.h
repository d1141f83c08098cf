// Smoothing along surfaces: an edge-stopping a-trous wavelet on light per reflectance, in passes
// twice as wide each. Further from the gaze more passes are taken. Biased. Sources: Dammertz et al.
// 2010 (filter), Schied et al. 2017 (stopping at differences beyond the noise).
#pragma once

#include "server/kernels/lightcuts/surfaces.h"

namespace macula::kernels::lightcuts {

using image::Plane;

/// `light` of one view, linear, of the cells of `surfaces`; cells without a surface are left alone.
/// `eccentricity`: radians.
scheduling::Outcome smooth(const ViewSurfaces& surfaces, const Vec3& eye,
                           const Plane<float>& eccentricity, TileScheduler& scheduler,
                           Plane<Rgb>& light);

}  // namespace macula::kernels::lightcuts
