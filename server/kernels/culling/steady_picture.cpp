#include "server/kernels/culling/steady_picture.h"

#include <algorithm>
#include <utility>

namespace macula::kernels::culling {

using scheduling::Outcome;

/// Tighter than elsewhere: what lamps that move or come on add to all around is to show at once.
constexpr float kDeviations = 1.0F;

Outcome steady_picture(const View& view, const reconstruction::PictureMemory* last,
                       const reconstruction::Movers& movers, int most_frames,
                       TileScheduler& scheduler, ViewBuffers& buffers,
                       reconstruction::PictureMemory& memory) {
  const image::Plane<Rgb>& fresh = buffers.radiance;
  image::Plane<float> inverse_depth(fresh.width(), fresh.height());
  std::ranges::transform(buffers.depth_m.pixels(), inverse_depth.pixels().begin(),
                         [](float depth) { return 1.0F / depth; });
  memory.world_from_view = view.world_from_view;
  memory.grid = view.grid;
  const reconstruction::SteadyConfig settings{static_cast<float>(most_frames), kDeviations};
  reconstruction::PictureJoin joined(last, settings, fresh, inverse_depth, memory);
  if (!movers.then_from_now.empty()) joined.follow(movers);
  image::Plane<Rgb> shown(fresh.width(), fresh.height());
  const auto rows = [&](const auto& body) {
    return scheduler.run(static_cast<std::size_t>(shown.height()),
                         [&](std::size_t row) { body(static_cast<int>(row)); });
  };
  Outcome outcome = rows([&](int y) { joined.prepare_row(y); });
  if (outcome == Outcome::Completed)
    outcome = rows([&](int y) { joined.join_row(y, shown.row(y)); });
  buffers.radiance = std::move(shown);
  return outcome;
}

}  // namespace macula::kernels::culling
