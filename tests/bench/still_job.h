// What stands behind a still: a scene with its structures, a view of it, and the render of that
// view by a kernel in passes. World space, meters; CPU times are those of the whole process.
#pragma once

#include <memory>
#include <string>

#include "server/kernels/kernel.h"
#include "server/kernels/scene_frame.h"
#include "shared/foveation/pixel_grid.h"
#include "shared/foveation/rate.h"
#include "tests/bench/still.h"

namespace macula::bench {

/// Everything one render needs, made from the options.
struct StillJob {
  std::shared_ptr<const kernels::SceneFrame> scene;
  foveation::Display display;
  foveation::RateModel rate;
  kernels::View view;
  std::string kernel;
  unsigned wanted = 0;        ///< kernels::PlaneFlag bits
  double load_cpu_ms = 0.0;   ///< reading or generating the scene
  double build_cpu_ms = 0.0;  ///< the structures kernels ask: BVH, lights, textures
};

struct RenderedStill {
  kernels::ViewBuffers planes;
  kernels::FrameReport report;
  double cpu_ms = 0.0;
};

/// Errors name the option or file at fault and what is allowed.
Result<StillJob> prepare_still(const StillOptions& options);
Result<RenderedStill> render_still(const StillJob& job, const StillOptions& options);

}  // namespace macula::bench
