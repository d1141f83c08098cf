// RankedKernel: a kernel whose frames are made by all ranks of a group, bit for bit the same as by
// one alone. Rank 0 renders through it as through any other kernel; the others follow(): they wait
// for rank 0's orders and render the same frames, each with histories of its own. Which rank runs
// which tile: scheduling/frame_sharing.h. shade() stays on rank 0.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "server/kernels/kernel.h"
#include "server/kernels/scene_timeline.h"
#include "server/scheduling/frame_sharing.h"

namespace macula::cluster {

/// One shared frame as a rank saw it, for measurements.
struct SharedFrame {
  std::vector<scheduling::PassRecord> passes;
  double frame_ms = 0.0;     ///< wall
  double cpu_ms = 0.0;       ///< of the calling thread
  double threaded_ms = 0.0;  ///< processor time of what ran on the scheduler's threads, all of them
};
using FrameWatcher = std::function<void(const SharedFrame&)>;

/// Rank 0's end of a group. One caller at a time, but forget().
class Leader {
 public:
  Leader(std::shared_ptr<scheduling::RankGroup> ranks, scheduling::Balance balance)
      : ranks_(std::move(ranks)), balance_(balance) {}

  /// Sends the others home; frames after it are stopped.
  void end();
  void watch(FrameWatcher watcher) { watcher_ = std::move(watcher); }

 private:
  friend class RankedKernel;
  friend struct RankedHistory;
  std::uint64_t new_history() { return ++histories_; }
  void forget(std::uint64_t history);
  std::vector<std::uint64_t> take_forgotten();

  std::shared_ptr<scheduling::RankGroup> ranks_;
  scheduling::Balance balance_;
  FrameWatcher watcher_;
  std::uint64_t histories_ = 0;
  bool ended_ = false;
  std::mutex mutex_;
  std::vector<std::uint64_t> forgotten_;
};

class RankedKernel final : public kernels::Kernel {
 public:
  /// `index`: of the kernel in the list that the others follow with.
  RankedKernel(std::shared_ptr<const kernels::Kernel> kernel, std::uint32_t index,
               std::shared_ptr<Leader> leader)
      : kernel_(std::move(kernel)), index_(index), leader_(std::move(leader)) {}

  /// Stopped, too, when a rank was lost.
  kernels::FrameReport render(const kernels::FrameRequest& request,
                              const kernels::SceneFrame& scene, kernels::History& history,
                              scheduling::TileScheduler& scheduler,
                              kernels::FrameBuffers& out) const override;
  void shade(std::span<const kernels::SurfacePoint> points, const kernels::SceneFrame& scene,
             scheduling::TileScheduler& scheduler, std::span<Rgb> out) const override {
    kernel_->shade(points, scene, scheduler, out);
  }

 private:
  std::shared_ptr<const kernels::Kernel> kernel_;
  std::uint32_t index_;
  std::shared_ptr<Leader> leader_;
};

/// What a rank that follows needs besides the group.
struct Followed {
  std::span<const std::shared_ptr<const kernels::Kernel>> kernels;
  kernels::SceneTimeline& scene;
  scheduling::TileScheduler& scheduler;
  scheduling::Balance balance = scheduling::Balance::Predicted;
  FrameWatcher watcher{};
};
/// Renders what rank 0 orders until it ends. Errors: a rank was lost; memory for the scene.
Result<void> follow(scheduling::RankGroup& ranks, const Followed& followed);

}  // namespace macula::cluster
