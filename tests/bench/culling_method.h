// The methods that `macula-bench culling` compares, as settings of kernel culling.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "server/kernels/culling/config.h"
#include "shared/base/result.h"

namespace macula::bench {

/// Which pixels are rendered; time is told for all. Picture: all. Fourth: the middles of every
/// fourth pixel each way are a picture of their own. Blocks: sample_of_blocks(), by every light
/// that is made: one row, whatever is kept.
enum class Rendering { Picture, Fourth, Blocks };

struct CullingMethod {
  std::string_view name;
  std::string_view summary;
  /// Turns the settings of flc_rays into its own.
  void (*set)(kernels::culling::Config& config);
  Rendering rendering = Rendering::Picture;
  /// Lights that it keeps in the time that flc takes for one.
  double lights_at_equal_time = 1.0;
};

std::span<const CullingMethod> culling_methods();
/// Unknown names answer with the list of names.
Result<const CullingMethod*> find_culling_method(const std::string& name);

/// K lights kept; the fovea is that of the experiment.
kernels::culling::Config culling_config(const CullingMethod& method, int kept);

}  // namespace macula::bench
