// The methods of `macula-bench sphere` by name, as settings of kernel `sphere`.
#pragma once

#include <string>

#include "server/kernels/sphere/config.h"
#include "shared/base/result.h"

namespace macula::bench {

/// One row's settings.
struct SphereCase {
  std::string scene, method;
  double fovea_deg = 0.0;  ///< 0 for methods without foveation
  int samples = 1;
  int refresh = 1;  ///< frames
  std::string edges = "none";
  int views = 1;

  bool foveated() const { return method == "fipr" || method == "fipr_paper"; }
  friend bool operator==(const SphereCase&, const SphereCase&) = default;
};

/// Unknown names answer with what there is.
Result<kernels::sphere::Config> sphere_config(const SphereCase& row);

}  // namespace macula::bench
