// Surfaces: what the primary rays of one frame met, kept so that light can be estimated in several
// ways, and where the eye cares, without tracing them again. One sample a cell. World, meters.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/kernels/parcels.h"
#include "server/kernels/ray/lighting.h"
#include "server/kernels/ray/tile.h"
#include "server/scheduling/row_bands.h"

namespace macula::kernels::lightcuts {

/// At most ray::kTileSide^2 cells of one view and the points on surfaces behind them.
struct SurfaceTile {
  image::Rect rect;
  ray::LitPoints points;
  static constexpr std::uint16_t kNone = 0xFFFF;
  std::array<std::uint16_t, sampling::kBatch> cell_of;   ///< of each point, by cell_index
  std::array<std::uint16_t, sampling::kBatch> point_of;  ///< of each cell; kNone: nothing was hit

  static std::size_t cell_index(int x, int y) {
    return static_cast<std::size_t>(y * ray::kTileSide + x);
  }
  image::Pixel pixel(std::size_t point) const {
    const int cell = cell_of[point];
    return {rect.x + cell % ray::kTileSide, rect.y + cell / ray::kTileSide};
  }
};

/// A point as the next of `to`, which has the same rectangle, to be lit there; `to` is not looked
/// up by cell.
void append(const SurfaceTile& from, std::size_t point, SurfaceTile& to);

/// One point of a tile.
struct SurfaceAt {
  const ray::LitPoints* points = nullptr;  ///< none: nothing was hit
  std::size_t index = 0;

  explicit operator bool() const { return points != nullptr; }
  Vec3 position() const { return points->position[index]; }
  Vec3 normal() const { return points->reflectors.shading[index]; }
};

struct ViewSurfaces {
  int columns = 0;  ///< tiles in a row of tiles
  int width = 0, height = 0;
  std::vector<SurfaceTile> tiles;

  /// Of its tiles, view number `index`.
  std::vector<scheduling::TilePlace> places(std::size_t index) const;
  SurfaceAt at(int x, int y) const {
    const int side = ray::kTileSide;
    const SurfaceTile& tile = tiles[static_cast<std::size_t>(y / side * columns + x / side)];
    const std::uint16_t point = tile.point_of[SurfaceTile::cell_index(x % side, y % side)];
    if (point == SurfaceTile::kNone) return {};
    return {&tile.points, point};
  }
};

/// body(tile, point, pixel) for every point in these rows, tiles on the bands' threads.
template <class Body>
scheduling::Outcome for_each_point(const ViewSurfaces& view, const scheduling::Band& rows,
                                   scheduling::RowBands& bands, const Body& body) {
  constexpr int kSide = ray::kTileSide;
  const auto columns = static_cast<std::size_t>(view.columns);
  return bands.run_tile_rows(rows, kSide, [&](const scheduling::Rows& part) {
    const std::size_t first = static_cast<std::size_t>(part.begin / kSide) * columns;
    for (std::size_t column = 0; column < columns; ++column) {
      const SurfaceTile& tile = view.tiles[first + column];
      for (std::size_t i = 0; i < tile.points.count; ++i) {
        const image::Pixel at = tile.pixel(i);
        if (at.y >= part.begin && at.y < part.end) body(tile, i, at);
      }
    }
  });
}

/// What is drawn at these points from now on has these random numbers.
void give_keys(const PixelGrid& grid, std::uint64_t seed, std::uint64_t frame, SurfaceTile& tile);
void give_keys(const PixelGrid& grid, std::uint64_t seed, std::uint64_t frame, ViewSurfaces& view);

/// Traces the centre (or, jittered, one random point) of every cell. Writes to prepared buffers:
/// radiance is what shines at the eye by itself; the guides that are wanted. Keeps memory.
FrameReport trace_surfaces(const FrameRequest& request, const SceneFrame& scene,
                           const ray::Config& config, TileScheduler& scheduler,
                           std::vector<ViewSurfaces>& surfaces, FrameBuffers& out);

}  // namespace macula::kernels::lightcuts
