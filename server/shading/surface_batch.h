// SurfaceBatch: how the surface of one instance lies at up to sampling::kBatch points, side by side,
// as SurfaceTable::at says it of one. World space, meters. Plain values.
#pragma once

#include "server/sampling/batch.h"

namespace macula::shading {

/// Points of one instance: triangles of its mesh with barycentric coordinates. Entries from the
/// count up to the next multiple of the vector's width must name points, too: repeat the last.
struct PointsOnTriangles {
  std::size_t count = 0;
  sampling::IndexBatch triangle;
  sampling::Vec2Batch barycentric;
};

struct SurfaceBatch {
  sampling::Vec3Batch position;   ///< rounded to floats
  sampling::Vec3Batch geometric;  ///< unit, towards the front face; 0 for a degenerate triangle
  sampling::Vec3Batch shading;    ///< unit; the geometric one where a mesh has none
  sampling::Vec2Batch uv;
  sampling::FloatBatch span_m;        ///< as Surface::span_m
  sampling::FloatBatch uv_per_meter;  ///< as SurfaceTable::uv_per_meter
};

}  // namespace macula::shading
