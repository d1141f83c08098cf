// Tile: one 16x16 block of cells of one view, from primary rays to finished planes. Lives on the
// stack of the thread that runs it. A cell's result is a function of its own rectangle, pose and
// key, so tiles may be cut anywhere without changing a bit.
#pragma once

#include "server/kernels/frame_buffers.h"
#include "server/kernels/kernel.h"
#include "server/kernels/ray/cell_pattern.h"
#include "server/kernels/ray/lighting.h"

namespace macula::kernels::ray {

inline constexpr int kTileSide = 16;
static_assert(kTileSide * kTileSide == visibility::kStreamCapacity);

/// Everything the tiles of one view share.
struct ViewContext {
  const View& view;
  const SceneFrame& scene;
  const Config& config;
  CellPattern pattern;
  Lighting lighting;
  std::uint64_t frame = 0, seed = 0;
  unsigned wanted = 0;
  Mat3 world_from_view{1.0F};
  Vec3 eye{0.0F};
  /// Most nodes of the cuts in each cell, >= 1 and at most Config::area_light_samples; none: that.
  const image::Plane<std::uint16_t>* cut_nodes = nullptr;
  /// Class of virtual lights that each cell asks; none: side by side, changing with the frame.
  const image::Plane<std::uint16_t>* light_class = nullptr;

  ViewContext(const View& view, const SceneFrame& scene, const Config& config,
              const FrameRequest& request, unsigned wanted);
};

/// Renders one tile into `out`; returns its share of the report.
FrameReport render_tile(const ViewContext& context, const image::Rect& tile, ViewBuffers& out);
/// Renders at most kTileSide^2 cells from anywhere in the view; near ones should follow each other.
FrameReport render_cells(const ViewContext& context, std::span<const image::Pixel> cells,
                         ViewBuffers& out);
/// The same, side by side: cell k's sample goes to (k, row) of `out`.
FrameReport render_cells(const ViewContext& context, std::span<const image::Pixel> cells, int row,
                         ViewBuffers& out);

}  // namespace macula::kernels::ray
