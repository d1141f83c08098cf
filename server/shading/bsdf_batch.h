// BsdfBatch: what up to sampling::kBatch points of one material are made of, side by side, as
// MaterialTable::bsdf says it of one. Plain values.
#pragma once

#include "server/sampling/batch.h"
#include "server/shading/bsdf.h"

namespace macula::shading {

/// What samples stand for where they meet surfaces, as SampleFootprint.
struct FootprintBatch {
  sampling::FloatBatch uv, width_m;
  sampling::Vec3Batch to_eye;  ///< unit, world
};

struct BsdfBatch {
  sampling::Vec3Batch base;  ///< base colour times texture or pattern: what the albedo plane shows
  sampling::Vec3Batch albedo, f0;
  sampling::FloatBatch f90, alpha;
  LobeModel lobe = LobeModel::Ggx;  ///< of all of them
};

}  // namespace macula::shading
