#include "server/kernels/ray/guide.h"

#include "server/kernels/planes.h"
#include "server/kernels/ray/full.h"

namespace macula::kernels::ray {
namespace {

std::vector<float> thinned_edges(const std::vector<float>& edges, int n) {
  std::vector<float> kept;
  for (std::size_t i = 0; i + 1 < edges.size(); i += static_cast<std::size_t>(n)) {
    kept.push_back(edges[i]);
  }
  kept.push_back(edges.back());
  return kept;
}

}  // namespace

std::vector<View> thinned(std::span<const View> views, int n) {
  std::vector<View> low(views.begin(), views.end());
  for (View& view : low) {
    view.grid = {thinned_edges(view.grid.x_edges, n), thinned_edges(view.grid.y_edges, n)};
  }
  return low;
}

FrameBuffers trace_surfaces(const FrameRequest& request, const SceneFrame& scene,
                            const Config& config, unsigned wanted, TileScheduler& scheduler,
                            FrameReport& report) {
  Config guide = config;
  guide.lights = LightChoice::None;
  guide.samples_per_cell = 1;
  guide.placement = Placement::Fixed;
  FrameBuffers buffers;
  buffers.wanted = wanted;
  prepare_buffers(request.views, buffers);
  report += render_full(request, scene, guide, scheduler, buffers, Audience::EveryRank);
  return buffers;
}

FoveationMap acuity_map(const FrameRequest& request, const foveation::RateModel& model) {
  std::vector<FoveationMap::ViewInput> inputs;
  for (std::size_t v = 0; v < request.views.size(); ++v) {
    inputs.push_back(request.foveation.view(v));
    inputs.back().grid = request.views[v].grid;
  }
  return FoveationMap(std::move(inputs), model);
}

}  // namespace macula::kernels::ray
