#include "server/session/view_builder.h"

#include <algorithm>
#include <cmath>

#include "shared/base/text.h"

namespace macula::session {
namespace {

Result<foveation::RateModel> wanted_model(const net::Settings& wish, const ViewPolicy& policy) {
  if (wish.rate_model.empty()) return policy.rate_model;
  return foveation::find_rate_model(wish.rate_model);
}

Result<std::size_t> checked_cells(const PixelGrid& grid, const ViewPolicy& policy) {
  if (!foveation::is_valid(grid) || grid.width() > policy.most_cells_a_side ||
      grid.height() > policy.most_cells_a_side)
    return base::bad_input(
        base::concat("a grid of ", grid.width(), " x ", grid.height(), " cells"),
        "the client's display",
        base::concat("at most ", policy.most_cells_a_side, " a side: ask for less oversampling"));
  return static_cast<std::size_t>(grid.width()) * static_cast<std::size_t>(grid.height());
}

}  // namespace

ScaledGrid make_scaled_grid(const foveation::Display& display, double scale, const Gaze& gaze,
                            const foveation::RateModel& model,
                            const foveation::FovealGridOptions& options) {
  const auto side = [&](int px) { return std::max(1, static_cast<int>(std::lround(px * scale))); };
  const foveation::Display small{display.fov, side(display.width_px), side(display.height_px)};
  const double shrunk = static_cast<double>(small.width_px) / display.width_px;
  foveation::FovealGridOptions scaled = options;
  scaled.fovea_oversampling /= shrunk;
  scaled.full_rate_radius = shrunk * options.full_rate_radius;
  return {small, foveation::make_foveal_grid(small, gaze, model, scaled)};
}

Result<PreparedViews> prepare_views(const net::ViewState& view, const ClientSetup& setup,
                                    const ViewPolicy& policy, double scale, GazeFilters& filters,
                                    std::span<const FollowedGaze> followed) {
  const auto model = wanted_model(setup.settings, policy);
  if (!model) return base::forward(model);
  const Pose world_from_head = policy.scene_from_stage * view.stage_from_head;

  std::vector<kernels::View> views;
  std::vector<FoveationMap::ViewInput> inputs;
  std::size_t cells = 0;
  for (std::size_t eye = 0; eye < view.eyes.size(); ++eye) {
    const net::EyeState& state = view.eyes[eye];
    const bool is_followed = eye < followed.size();
    const Gaze gaze = is_followed ? followed[eye].gaze : filters[eye].update(state.gaze);
    const Gaze centre = is_followed ? followed[eye].centre : gaze;
    const Degrees radius = is_followed ? followed[eye].radius : policy.full_rate_radius;
    const net::Settings& wish = setup.settings;
    const foveation::Display announced{state.fov, setup.eyes[eye].width_px,
                                       setup.eyes[eye].height_px};
    auto [display, grid] = make_scaled_grid(
        announced, scale, centre, *model,
        {.fovea_oversampling =
             wish.fovea_oversampling != 0.0 ? wish.fovea_oversampling : policy.fovea_oversampling,
         .full_rate_radius = radius,
         .guard_band = policy.guard_band});
    const auto count = checked_cells(grid, policy);
    if (!count) return base::forward(count);
    cells += *count;
    inputs.push_back({grid, gaze, display.pixel_tangent()});
    views.push_back({world_from_head * state.head_from_eye, std::move(grid), gaze, policy.tone});
  }
  if (cells > policy.most_cells)
    return base::bad_input(base::concat("a frame of ", cells, " cells"), "the client's display",
                           base::concat("at most ", policy.most_cells));
  return PreparedViews{std::move(views), FoveationMap(std::move(inputs), *model), cells};
}

}  // namespace macula::session
