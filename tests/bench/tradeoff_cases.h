// What `macula-bench tradeoff` measures of each kernel: its scenes, and its configurations. Those
// are words "name=value": grid, scale, model (or a ramp of rates by inner, outer and floor), jpeg
// and depth say how a frame is sampled and sent, every other word is a knob of the kernel
// (server/kernels/knobs.h).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/kernels/knobs.h"
#include "shared/base/result.h"
#include "shared/foveation/rate.h"

namespace macula::bench {

enum class FrameGrid { Foveal, Uniform };

/// A configuration, read.
struct FrameSettings {
  FrameGrid grid = FrameGrid::Foveal;
  double scale = 1.0;          ///< of the periphery's resolution (foveal), or of all (uniform)
  foveation::RateModel model;  ///< of the grid, and of methods that leave cells out
  std::optional<int> jpeg;     ///< errors are those after coding; none: before, bytes at 85
  int depth_divisor = 1;
  kernels::KnobValues knobs;
};
/// Errors name the word and what is allowed; knobs are checked by the kernel.
Result<FrameSettings> parse_frame_settings(std::string_view config);

/// One kernel's experiment.
struct TradeoffKernel {
  std::string_view name;
  std::string_view reference;  ///< kernel that makes its references, mode exact
  int bounces;                 ///< of the reference
  std::vector<std::string> scenes;
  std::vector<std::string> uniform;  ///< the baseline, by rising cost
  std::vector<std::string> knobs;    ///< one at a time round the default, and joint ones
  std::vector<std::string> costly;   ///< what --quick leaves out
};
std::span<const TradeoffKernel> tradeoff_kernels();

}  // namespace macula::bench
