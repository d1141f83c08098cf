// What the middle level keeps from the last frame. A cell whose turn to be traced has not come is
// looked up where the surface it sees now lay then (backward warp from the low level's depth, which
// is of this frame), or in place. Where edges are near, where the last picture has nothing that
// matches in depth, or where it is too old, the cell is traced after all.
#pragma once

#include <cstdint>

#include "server/kernels/history.h"
#include "server/kernels/kernel.h"
#include "server/kernels/sphere/config.h"
#include "server/kernels/sphere/edges.h"
#include "server/kernels/sphere/levels.h"

namespace macula::kernels::sphere {

/// The last frame of one view.
struct ViewHistory {
  Pose world_from_view;
  PixelGrid mid_grid;
  MidLevel mid;
  std::uint64_t frame = 0;
};

/// What kernel `sphere` remembers of a session.
struct SphereHistory final : HistoryRecord {
  std::vector<ViewHistory> views;
};

struct KeepInput {
  const View& view;
  const PixelGrid& mid_grid;
  const LowLevel& low;
  const Plane<float>& edges;  ///< of the low level
  std::uint64_t frame = 0;
  const Config& config;
};

/// Frames between two tracings of an unimportant cell: 1, 2 or 4.
int period(Refresh refresh);
/// Whether a cell of the middle level is traced in this frame whatever is known of it: all of them
/// at EveryFrame, one of a pair or one of four neighbours in turn otherwise.
bool is_due(int x, int y, std::uint64_t frame, Refresh refresh);

/// Turns Traced into Kept in `mid.source`, with the values kept. A history of another grid, of no
/// or of more than one frame ago keeps nothing.
void keep(const KeepInput& input, const ViewHistory& last, TileScheduler& scheduler, MidLevel& mid);

}  // namespace macula::kernels::sphere
