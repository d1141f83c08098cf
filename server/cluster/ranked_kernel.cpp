#include "server/cluster/ranked_kernel.h"

#include <chrono>
#include <map>
#include <utility>

#include "server/cluster/frame_order.h"
#include "shared/base/check.h"
#include "shared/base/cpu_time.h"

namespace macula::cluster {

using scheduling::CostForecast;
using scheduling::FrameSharing;
using scheduling::TilePlace;

namespace {

/// What a rank remembers of the frames of one history.
struct RankMemory {
  kernels::History history;
  CostForecast forecast;
  std::vector<kernels::View> views;  ///< of the last frame
};

/// Where a share of a grid lies on the tangent plane.
Vec2 tangent_at(const PixelGrid& grid, const Vec2& share) {
  const auto edge = [](const std::vector<float>& edges, float at) {
    const float place = at * static_cast<float>(edges.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(place), edges.size() - 2);
    return std::lerp(edges[below], edges[below + 1], place - static_cast<float>(below));
  };
  return {edge(grid.x_edges, share.x), edge(grid.y_edges, share.y)};
}

/// Follows a direction, as if all were far away, from this frame's views into the last one's.
scheduling::PlaceThen turned(std::span<const kernels::View> now,
                             std::span<const kernels::View> then) {
  if (now.size() != then.size()) return {};
  return [now, then](const TilePlace& tile) -> std::optional<Vec2> {
    const kernels::View& from = now[tile.view];
    const kernels::View& to = then[tile.view];
    const DVec3 seen(math::direction_from_tangent(tangent_at(from.grid, tile.at)));
    const DVec3 world = from.world_from_view.transform_direction(seen);
    const Vec3 there(math::inverse(to.world_from_view).transform_direction(world));
    const auto cell = to.grid.project(there);
    if (!cell) return std::nullopt;
    return *cell / Vec2(static_cast<float>(to.grid.width()), static_cast<float>(to.grid.height()));
  };
}

struct Watch {
  bool wanted = false;          ///< the same on all ranks
  const FrameWatcher& watcher;  ///< of this one; may be none
};

/// Every rank's part of a frame: the kernel, with its passes shared.
kernels::FrameReport render_shared(scheduling::RankGroup& ranks, scheduling::Balance balance,
                                   const kernels::Kernel& kernel,
                                   const kernels::FrameRequest& request,
                                   const kernels::SceneFrame& scene, RankMemory& memory,
                                   scheduling::TileScheduler& scheduler, kernels::FrameBuffers& out,
                                   const Watch& watch) {
  const auto begin = std::chrono::steady_clock::now();
  const double begin_cpu = base::thread_cpu_ms();
  const std::vector<kernels::View> last =
      std::exchange(memory.views, {request.views.begin(), request.views.end()});
  memory.forecast.begin_frame(turned(request.views, last));
  FrameSharing sharing(ranks, balance, memory.forecast);
  scheduler.share(&sharing);
  kernels::FrameReport report = kernel.render(request, scene, memory.history, scheduler, out);
  scheduler.share(nullptr);
  if (report.stopped) memory.forecast = {};
  if (!watch.wanted) return report;
  const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - begin;
  const double cpu_ms = base::thread_cpu_ms() - begin_cpu;
  if (report.stopped || !sharing.tell_row_costs()) return report;
  if (watch.watcher) watch.watcher({sharing.passes(), wall.count(), cpu_ms, sharing.body_ms()});
  return report;
}

Error lost(const scheduling::RankGroup& ranks) {
  return Error{ranks.lost(), "cluster", "start the server again; see docs of deploy/slurm",
               base::ErrorKind::Runtime};
}

}  // namespace

/// Rank 0's record; the others forget theirs when it goes.
struct RankedHistory final : kernels::HistoryRecord {
  explicit RankedHistory(std::shared_ptr<Leader> of) : leader(std::move(of)) {}
  ~RankedHistory() override { leader->forget(id); }

  std::shared_ptr<Leader> leader;
  std::uint64_t id = leader->new_history();
  RankMemory memory;
};

void Leader::forget(std::uint64_t history) {
  std::lock_guard lock(mutex_);
  forgotten_.push_back(history);
}

std::vector<std::uint64_t> Leader::take_forgotten() {
  std::lock_guard lock(mutex_);
  return std::exchange(forgotten_, {});
}

void Leader::end() {
  if (std::exchange(ended_, true) || !ranks_->lost().empty()) return;
  FrameOrder order;
  order.ends = true;
  scheduling::Bytes bytes = order.bytes();
  (void)ranks_->broadcast(bytes);
}

kernels::FrameReport RankedKernel::render(const kernels::FrameRequest& request,
                                          const kernels::SceneFrame& scene,
                                          kernels::History& history,
                                          scheduling::TileScheduler& scheduler,
                                          kernels::FrameBuffers& out) const {
  kernels::FrameReport stopped;
  stopped.stopped = true;
  if (leader_->ended_) return stopped;
  auto* record = dynamic_cast<RankedHistory*>(history.record.get());
  if (record == nullptr) {
    auto made = std::make_unique<RankedHistory>(leader_);
    record = made.get();
    history.record = std::move(made);
  }
  FrameOrder order;
  order.kernel = index_, order.history = record->id;
  order.forgotten = leader_->take_forgotten();
  order.scene_time = scene.time(), order.frame = request.frame, order.seed = request.seed;
  order.wanted = out.wanted, order.watched = static_cast<bool>(leader_->watcher_);
  order.views.assign(request.views.begin(), request.views.end());
  for (std::size_t v = 0; v < request.foveation.view_count(); ++v)
    order.foveation.push_back(request.foveation.view(v));
  order.model = request.foveation.model();
  scheduling::Bytes bytes = order.bytes();
  if (!leader_->ranks_->broadcast(bytes)) return stopped;
  return render_shared(*leader_->ranks_, leader_->balance_, *kernel_, request, scene,
                       record->memory, scheduler, out, {order.watched, leader_->watcher_});
}

Result<void> follow(scheduling::RankGroup& ranks, const Followed& followed) {
  std::map<std::uint64_t, RankMemory> memories;
  kernels::FrameBuffers out;
  for (;;) {
    scheduling::Bytes bytes;
    if (!ranks.broadcast(bytes)) return tl::unexpected(lost(ranks));
    const FrameOrder order = FrameOrder::from(bytes);
    if (order.ends) return {};
    for (const std::uint64_t history : order.forgotten) memories.erase(history);
    const auto scene = followed.scene.at(order.scene_time);
    if (!scene) return base::forward(scene);
    const FoveationMap foveation(order.foveation, order.model);
    const kernels::FrameRequest request{order.views, foveation, order.frame, order.seed};
    MACULA_CHECK(order.kernel < followed.kernels.size(), "ranks have the same kernels");
    out.wanted = order.wanted;
    (void)render_shared(ranks, followed.balance, *followed.kernels[order.kernel], request, **scene,
                        memories[order.history], followed.scheduler, out,
                        {order.watched, followed.watcher});
    if (!ranks.lost().empty()) return tl::unexpected(lost(ranks));
  }
}

}  // namespace macula::cluster
