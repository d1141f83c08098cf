// The render stage: a started frame becomes views on foveal grids, the scene is taken to this
// moment of its clock, and the kernel fills the job's buffers. Called by the render thread only.
#pragma once

#include <memory>
#include <stop_token>

#include "server/kernels/kernel.h"
#include "server/kernels/scene_timeline.h"
#include "server/session/config.h"
#include "server/session/frame_job.h"
#include "server/session/scene_clock.h"
#include "shared/base/clock.h"
#include "shared/base/result.h"

namespace macula::session {

enum class RenderOutcome { Rendered, Stopped };

class RenderStage {
 public:
  RenderStage(const ServerConfig& config, std::shared_ptr<kernels::SceneTimeline> scene,
              std::shared_ptr<const kernels::Kernel> kernel,
              std::shared_ptr<scheduling::TileScheduler> scheduler, const base::Clock& clock);

  /// Stopped when `stop` fired: the buffers are incomplete. Errors: views that cannot be prepared,
  /// memory for the scene's moment.
  Result<RenderOutcome> render(FrameJob& job, RenderMemory& memory, std::stop_token stop);

 private:
  /// The kernel with the knobs of the frame's step turned; another step starts a new history.
  const kernels::Kernel& kernel_for(const FrameJob& job, RenderMemory& memory) const;
  void judge(FrameJob& job, const kernels::SceneFrame& scene);
  /// Whether there is a second layer to make: the client may see another side of something.
  static bool wants_hidden(const FrameJob& job, const kernels::SceneFrame& scene);
  scheduling::Outcome render_hidden(FrameJob& job, const kernels::Kernel& kernel,
                                    const kernels::SceneFrame& scene);
  ServerTime now() const { return ServerTime{clock_.now()}; }

  const ServerConfig& config_;
  std::shared_ptr<kernels::SceneTimeline> scene_;
  std::shared_ptr<const kernels::Kernel> kernel_;
  std::shared_ptr<scheduling::TileScheduler> scheduler_;
  const base::Clock& clock_;
  const SceneClock scene_clock_;
};

}  // namespace macula::session
