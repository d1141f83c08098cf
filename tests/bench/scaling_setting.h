// What `macula-bench scaling` renders: a kernel on a scene of its own, two eyes of a head that
// turns, on foveal grids around a gaze. All ranks make the same.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/cluster/ranked_kernel.h"
#include "server/kernels/scene_timeline.h"
#include "server/scheduling/rank_group.h"
#include "tests/bench/still.h"

namespace macula::bench {

class ScalingSetting {
 public:
  /// `workload`: ao16 (kernel ray), lightcuts, culling or sphere. Errors: no such workload or
  /// scene.
  static Result<std::unique_ptr<ScalingSetting>> create(const std::string& workload,
                                                        const std::string& scene, int width_px,
                                                        int height_px);
  static std::vector<std::string> workloads();
  static std::string standard_scene(const std::string& workload);

  /// Frames [0, count) through `kernel`, each told to `done`; false: one was stopped.
  bool render(const kernels::Kernel& kernel, const StillGaze& gaze, int count,
              scheduling::TileScheduler& scheduler) const;
  const std::vector<std::shared_ptr<const kernels::Kernel>>& kernels() const { return kernels_; }
  kernels::SceneTimeline& timeline() const { return *timeline_; }

 private:
  ScalingSetting() = default;
  std::vector<kernels::View> views_at(int frame, const StillGaze& gaze) const;

  std::shared_ptr<kernels::SceneTimeline> timeline_;
  std::vector<std::shared_ptr<const kernels::Kernel>> kernels_;  ///< one
  foveation::Display display_;
};

}  // namespace macula::bench
