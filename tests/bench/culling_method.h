// The methods that `macula-bench culling` compares, as settings of kernel culling.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "server/kernels/culling/config.h"
#include "shared/base/result.h"

namespace macula::bench {

struct CullingMethod {
  std::string_view name;
  std::string_view summary;
  /// Turns the settings of flc_rays into its own.
  void (*set)(kernels::culling::Config& config);
  bool keeps_all = false;  ///< lights: one row, rendered for a sample of the pixels
};

std::span<const CullingMethod> culling_methods();
/// Unknown names answer with the list of names.
Result<const CullingMethod*> find_culling_method(const std::string& name);

/// K lights kept; the fovea is that of the experiment.
kernels::culling::Config culling_config(const CullingMethod& method, int kept);

}  // namespace macula::bench
