// What tiles of kernels leave behind, as parcels between ranks carry it.
#pragma once

#include <span>

#include "server/kernels/kernel.h"
#include "server/sampling/batch.h"
#include "server/scheduling/run_shared.h"

namespace macula::kernels {

using scheduling::Audience;
using scheduling::Parcel;

/// Counts and times; shortcuts are the frame's, not a tile's.
inline void carry(FrameReport& report, Parcel& parcel) {
  for (std::uint64_t* count :
       {&report.primary_rays, &report.shadow_rays, &report.non_finite_samples,
        &report.field_evaluations, &report.field_operations, &report.unfinished_rays,
        &report.walked_nodes, &report.taken_nodes}) {
    parcel.value(*count);
  }
  parcel.value(report.trace_ms);
  parcel.value(report.shade_ms);
}

/// apply(plane) for every plane that tiles write: all but the rate, which is filled by rows.
template <class Apply>
void for_each_plane(ViewBuffers& view, const Apply& apply) {
  apply(view.radiance), apply(view.depth_m), apply(view.surface_id), apply(view.normal);
  apply(view.albedo), apply(view.motion), apply(view.variance), apply(view.samples);
  apply(view.steps), apply(view.light), apply(view.reflectance);
}
inline void carry(ViewBuffers& view, const image::Rect& rect, Parcel& parcel) {
  for_each_plane(view, [&](auto& plane) { parcel.rect(plane, rect); });
}
inline void carry(ViewBuffers& view, std::span<const image::Pixel> cells, Parcel& parcel) {
  for_each_plane(view, [&](auto& plane) { parcel.cells(plane, cells); });
}

/// The first `count` of a batch.
inline void carry(sampling::FloatBatch& batch, std::size_t count, Parcel& parcel) {
  parcel.values(std::span(batch.at, count));
}
inline void carry(sampling::Vec3Batch& batch, std::size_t count, Parcel& parcel) {
  for (float* axis : {batch.x, batch.y, batch.z}) parcel.values(std::span(axis, count));
}

/// Places of batches of at most `size` cells each, by the first of every batch.
inline auto by_batches(std::span<const image::Pixel> cells, std::size_t size, const PixelGrid& grid,
                       std::size_t view) {
  return [cells, size, &grid, view] {
    std::vector<scheduling::TilePlace> places;
    for (std::size_t first = 0; first < cells.size(); first += size) {
      const image::Pixel& cell = cells[first];
      places.push_back(
          scheduling::place_of({cell.x, cell.y, 1, 1}, grid.width(), grid.height(), view));
      places.back().work = static_cast<float>(std::min(size, cells.size() - first));
    }
    return places;
  };
}

}  // namespace macula::kernels
