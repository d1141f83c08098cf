// LitBatch: what is made of a SurfaceBatch while it is lit, side by side: its reflectors, the light
// that arrives, base colours and radiance. Kept by its thread from batch to batch: entries beyond
// the count are read and overwritten, so it is zero before first use.
#pragma once

#include "server/lights/light_list.h"
#include "server/sampling/batch.h"
#include "server/shading/reflector_batch.h"

namespace macula::kernels::sphere {

struct LitBatch {
  sampling::Vec3Batch base_color;  ///< linear reflectance under the pattern
  sampling::Vec3Batch radiance;    ///< towards the eye, W/(sr m^2)

  shading::ReflectorBatch reflectors;
  lights::ArrivalBatch arrival;   ///< from one light
  sampling::Vec3Batch reflected;  ///< of it, were nothing in the way
  sampling::Vec3Batch world;      ///< positions of the points, and the boxes that samples cover
  sampling::Vec3Batch box;
  sampling::FloatBatch share;  ///< of a pattern's second colour; of a light or the sky
};

}  // namespace macula::kernels::sphere
