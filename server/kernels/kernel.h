// The kernel interface: foveation is data, a kernel is a method, the grid is where.
// A kernel holds configuration only; what a frame needs comes in, what it made goes out.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/kernels/frame_buffers.h"
#include "server/kernels/history.h"
#include "server/kernels/scene_frame.h"
#include "server/scheduling/tile_scheduler.h"
#include "shared/foveation/foveation_map.h"
#include "shared/foveation/pixel_grid.h"
#include "shared/image/tone.h"
#include "shared/math/pose.h"

namespace macula::kernels {

using scheduling::TileScheduler;

struct View {
  Pose world_from_view;
  PixelGrid grid;
  Gaze gaze;
  image::Tone tone;
};

struct FrameRequest {
  std::span<const View> views;  ///< one, two or more; meters
  const FoveationMap& foveation;
  std::uint64_t frame = 0, seed = 0;
};

/// Work done and shortcuts taken in one frame; summed over its views.
struct FrameReport {
  bool stopped = false;  ///< the stop token fired: the buffers are incomplete, do not send them
  std::uint64_t primary_rays = 0;
  std::uint64_t shadow_rays = 0;
  std::uint64_t non_finite_samples = 0;  ///< replaced by black and counted
  std::uint64_t field_evaluations = 0;   ///< of a distance field, a point each; cones included
  std::uint64_t field_operations = 0;    ///< lane operations of these
  std::uint64_t unfinished_rays = 0;     ///< that ran out of steps or met a field that is no number
  double trace_ms = 0.0,
         shade_ms = 0.0;  ///< thread-summed shares of the frame where a kernel has them
  std::vector<std::string> biased_shortcuts;  ///< empty in mode exact

  // Cuts of a light tree: nodes whose light was found by a walk, or taken from other cells' draws.
  std::uint64_t walked_nodes = 0, taken_nodes = 0;

  // Methods that trace some cells and remember the others; thread-summed CPU times.
  std::uint64_t resampled_cells = 0;  ///< traced because memory failed or was contradicted
  std::uint64_t filled_cells = 0;     ///< neither traced nor remembered
  double sample_ms = 0.0;             ///< rays and shading
  double reproject_ms = 0.0;
  double mask_ms = 0.0;  ///< deciding which cells are traced; of the calling thread
  double cache_ms = 0.0;
  double merge_ms = 0.0;
  double post_ms = 0.0;

  /// Adds another part's work; stopped if either was. Shortcuts stay this part's.
  FrameReport& operator+=(const FrameReport& part) {
    stopped = stopped || part.stopped;
    primary_rays += part.primary_rays, shadow_rays += part.shadow_rays;
    non_finite_samples += part.non_finite_samples;
    field_evaluations += part.field_evaluations, field_operations += part.field_operations;
    unfinished_rays += part.unfinished_rays;
    walked_nodes += part.walked_nodes, taken_nodes += part.taken_nodes;
    trace_ms += part.trace_ms, shade_ms += part.shade_ms;
    resampled_cells += part.resampled_cells, filled_cells += part.filled_cells;
    sample_ms += part.sample_ms, reproject_ms += part.reproject_ms, mask_ms += part.mask_ms;
    cache_ms += part.cache_ms, merge_ms += part.merge_ms, post_ms += part.post_ms;
    return *this;
  }
};

/// A point to shade, e.g. of the second layer: what a ray hit, and where it came from.
struct SurfacePoint {
  DVec3 position{0.0};          ///< world, meters
  Vec3 geometric_normal{0.0F};  ///< unit, world, towards the eye
  Vec3 to_eye{0.0F};            ///< unit, world
  std::uint32_t instance = 0, triangle = 0;
  Vec2 barycentric{0.0F};
  float footprint_m = 0.0F;  ///< width of the cell at the point, for texture filtering
  /// Identity of its random numbers; sampling::SampleKey(seed, frame, PixelGrid::cell_key).value
  /// repeats those of the first sample of that cell.
  std::uint64_t key = 0;

  /// As a ray would have met it; its gap is the one of points that sdf::Tracer finds.
  visibility::Hit hit() const {
    return {0.0F,
            barycentric.x,
            barycentric.y,
            geometric_normal,
            instance,
            triangle,
            FieldRays::gap_at(footprint_m)};
  }
};

class Kernel {
 public:
  virtual ~Kernel() = default;
  /// One frame into `out`: linear Rec.709 radiance, view depth in meters, and the planes asked for.
  virtual FrameReport render(const FrameRequest& request, const SceneFrame& scene, History& history,
                             TileScheduler& scheduler, FrameBuffers& out) const = 0;
  /// Radiance leaving surface points towards the eye. out.size() == points.size().
  virtual void shade(std::span<const SurfacePoint> points, const SceneFrame& scene,
                     TileScheduler& scheduler, std::span<Rgb> out) const = 0;
};

}  // namespace macula::kernels
