// From a client's view state to what a kernel renders: one view per eye in world space, on a foveal
// grid around the filtered gaze, and the rate map of both. Pure.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/kernels/kernel.h"
#include "server/session/actions.h"
#include "server/session/config.h"
#include "shared/base/result.h"
#include "shared/foveation/foveation_map.h"
#include "shared/foveation/gaze_filter.h"

namespace macula::session {

/// One filter per eye, kept from frame to frame.
using GazeFilters = std::array<foveation::GazeFilter, 2>;

struct PreparedViews {
  std::vector<kernels::View> views;
  FoveationMap foveation;
  std::size_t cells = 0;
};

/// A foveal grid for a display shrunk by `scale` (0, 1]: cells of the whole display's own size keep
/// the disc around the gaze, shrunk likewise, and the periphery pays.
struct ScaledGrid {
  foveation::Display display;  ///< shrunk; its pixels are the nominal ones that rates refer to
  PixelGrid grid;
};
ScaledGrid make_scaled_grid(const foveation::Display& display, double scale, const Gaze& gaze,
                            const foveation::RateModel& model,
                            const foveation::FovealGridOptions& options);

/// `followed`, by eye, says where grids rest and how wide full quality is; without it both follow
/// the view's gaze and the policy. `scale` (0, 1] shrinks the nominal display that rates refer to,
/// and the disc around the gaze that keeps the real display's resolution; the field of view stays.
/// Errors: more cells than the policy allows, a rate model nobody knows.
Result<PreparedViews> prepare_views(const net::ViewState& view, const ClientSetup& setup,
                                    const ViewPolicy& policy, double scale, GazeFilters& filters,
                                    std::span<const FollowedGaze> followed = {});

}  // namespace macula::session
