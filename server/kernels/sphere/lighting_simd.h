// The vector loops of Lighting and HitShader: each point by itself, whatever lies beside it. Inside
// server/kernels/sphere.
#pragma once

#include <cstdint>

#include "server/kernels/sphere/lit_batch.h"
#include "server/kernels/sphere/surface_batch.h"

namespace macula::kernels::sphere {

/// `surfaces.position` holds unit directions, `surfaces.cell_m` areas of cells on the tangent
/// plane; with them, and ways `t`, it gets its positions, directions to the eye and widths, and
/// `depth_m` the view depths. `per_sample`: of a cell's width, what a sample covers.
void place_surfaces(const sampling::FloatBatch& t, const Vec3& forward, float per_sample,
                    SurfaceBatch& surfaces, sampling::FloatBatch& depth_m);

/// World positions, and the boxes that samples cover, as shading::covered_box has them.
void cover(const SurfaceBatch& points, const Vec3& eye, LitBatch& lit);

/// A matte material: its colours, the diffuse share of them, and what it sends out itself.
struct MatteRow {
  Rgb base{0.0F}, second{0.0F};
  float diffuse = 1.0F;
  Rgb emission{0.0F};
};
/// Base colour, reflectances and own radiance of the points of one material; with `share`, that
/// much of its colour is the second.
void take_matte(const SurfaceBatch& points, scene::Index material, const MatteRow& row,
                const sampling::FloatBatch* share, LitBatch& lit);
/// Frames of reflectors without a lobe: normals turned to the eye.
void face_eye(const SurfaceBatch& points, LitBatch& lit);

/// radiance += share * light; share null: 1.
void add(const sampling::Vec3Batch& light, const sampling::FloatBatch* share, std::size_t count,
         sampling::Vec3Batch& radiance);
/// radiance += share * light * reflectance; share null: 1.
void add_reflected(const Rgb& light, const sampling::Vec3Batch& reflectance,
                   const sampling::FloatBatch* share, std::size_t count,
                   sampling::Vec3Batch& radiance);

/// Replaces radiance that is not finite by black; returns how many points had it.
std::uint64_t blacken_non_finite(std::size_t count, sampling::Vec3Batch& radiance);

}  // namespace macula::kernels::sphere
