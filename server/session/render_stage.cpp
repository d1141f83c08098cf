#include "server/session/render_stage.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "server/session/error_estimate.h"

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

const kernels::Kernel& RenderStage::kernel_for(const FrameJob& job, RenderMemory& memory) const {
  const std::uint32_t step = job.start.quality.step;
  if (step >= config_.ladder_kernels.size()) return *kernel_;
  if (memory.ladder_step != step) memory.history = {};
  memory.ladder_step = step;
  return *config_.ladder_kernels[step];
}

/// By the first eye; both show the same scene at the same quality.
void RenderStage::judge(FrameJob& job, const kernels::SceneFrame& scene) {
  job.error.reset();
  if (job.start.quality.judgement == 0 || config_.reference == nullptr) return;
  foveation::Display display = job.start.setup->eyes.front();
  display.fov = job.start.view.eyes.front().fov;
  job.error = spot_error(*config_.reference, scene,
                         {job.views.front(), display, job.start.quality.judgement, config_.seed},
                         job.buffers.views.front().radiance, *scheduler_);
}

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
  const kernels::Kernel& kernel = kernel_for(job, memory);
  job.report = kernel.render(request, **scene, memory.history, *scheduler_, job.buffers);
  if (!job.report.stopped && wants_hidden(job, **scene)) {
    job.report.stopped = render_hidden(job, kernel, **scene) == scheduling::Outcome::Stopped;
  } else {
    job.hidden.clear();
  }
  std::this_thread::sleep_for(config_.delays.render);
  job.render_end = now();
  if (job.report.stopped) return RenderOutcome::Stopped;
  judge(job, **scene);
  return RenderOutcome::Rendered;
}

bool RenderStage::wants_hidden(const FrameJob& job, const kernels::SceneFrame& scene) {
  const scene::ScenePlan& plan = scene.plan();
  const bool has_surfaces =
      plan.has(scene::Step::TriangleBvh) || plan.has(scene::Step::DistanceField);
  return has_surfaces && job.start.view_cell_m > 0.0;
}

scheduling::Outcome RenderStage::render_hidden(FrameJob& job, const kernels::Kernel& kernel,
                                               const kernels::SceneFrame& scene) {
  job.hidden.resize(job.views.size());
  for (std::size_t eye = 0; eye < job.views.size(); ++eye) {
    const disocclusion::HiddenRequest request{job.views[eye], job.buffers.views[eye].depth_m,
                                              job.start.view_cell_m, job.start.key.frame,
                                              config_.seed};
    const auto outcome =
        disocclusion::trace_hidden_layer(request, kernel, scene, *scheduler_, job.hidden[eye]);
    if (outcome == scheduling::Outcome::Stopped) return outcome;
  }
  return scheduling::Outcome::Completed;
}

}  // namespace macula::session
