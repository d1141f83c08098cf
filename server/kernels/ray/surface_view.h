// What samples stand for on the surfaces they meet, and where rays leave these, in vectors.
#pragma once

#include "server/sampling/batch.h"
#include "server/shading/bsdf_batch.h"
#include "server/shading/surface_batch.h"

namespace macula::kernels::ray {

/// Of the rays that met the surfaces; as SurfaceGroup has them.
struct MeetingRays {
  const sampling::Vec3Batch& direction;
  const sampling::FloatBatch &t, &sample_area;
};

/// Directions to the eye, and footprints as ShadingRequest and a tile have them one by one: a
/// tangent area A at depth z covers the solid angle A cos^3 and, at distance z / cos, the area
/// A z^2 cos.
void measure_footprints(const MeetingRays& rays, const shading::SurfaceBatch& surfaces,
                        std::size_t count, shading::FootprintBatch& out);

/// visibility::offset_ray_origin of every point, towards `normal`'s side.
void offset_origins(const shading::SurfaceBatch& surfaces, const sampling::Vec3Batch& normal,
                    std::size_t count, sampling::Vec3Batch& out);

}  // namespace macula::kernels::ray
