#include "server/session/render_stage.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace macula::session {

RenderStage::RenderStage(const ServerConfig& config, std::shared_ptr<kernels::SceneTimeline> scene,
                         std::shared_ptr<const kernels::Kernel> kernel,
                         std::shared_ptr<scheduling::TileScheduler> scheduler,
                         const base::Clock& clock)
    : config_(config),
      scene_(std::move(scene)),
      kernel_(std::move(kernel)),
      scheduler_(std::move(scheduler)),
      clock_(clock),
      scene_clock_(now()) {}

Result<RenderOutcome> RenderStage::render(FrameJob& job, RenderMemory& memory,
                                          std::stop_token stop) {
  std::this_thread::sleep_for(config_.delays.view_wait);
  job.render_begin = now();
  job.scale = job.start.quality.scale;
  ViewPolicy policy = config_.views;
  policy.guard_band = Degrees{std::max(policy.guard_band.value(), job.start.guard_band.value())};
  job.guard_band = policy.guard_band;
  auto prepared = prepare_views(job.start.view, *job.start.setup, policy, job.scale, memory.gaze,
                                job.start.gazes);
  if (!prepared) return base::forward(prepared);
  job.views = std::move(prepared->views);
  job.cells = prepared->cells;
  job.rate_model = prepared->foveation.model();

  job.scene_time = job.start.scene_time.value_or(scene_clock_.at(job.render_begin));
  const auto scene = scene_->at(job.scene_time);
  if (!scene) return base::forward(scene);

  scheduler_->set_stop_token(std::move(stop));
  const kernels::FrameRequest request{job.views, prepared->foveation, job.start.key.frame,
                                      config_.seed};
  job.report = kernel_->render(request, **scene, memory.history, *scheduler_, job.buffers);
  std::this_thread::sleep_for(config_.delays.render);
  job.render_end = now();
  if (job.report.stopped) return RenderOutcome::Stopped;
  return RenderOutcome::Rendered;
}

}  // namespace macula::session
