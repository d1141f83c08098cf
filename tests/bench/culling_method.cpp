#include "tests/bench/culling_method.h"

#include <array>
#include <limits>

#include "shared/base/text.h"
#include "tests/bench/culling_setting.h"

namespace macula::bench {
namespace {

using kernels::culling::Config;

constexpr std::array kMethods{
    CullingMethod{"flc_rays", "contributions with traced visibility", [](Config&) {}},
    CullingMethod{"power", "kept by flux",
                  [](Config& c) { c.kept_by = kernels::culling::KeptBy::Flux; }},
    CullingMethod{"all_vpls", "every light from every pixel, a shadow ray each",
                  [](Config& c) {
                    c.kept = std::numeric_limits<int>::max();
                    c.classes = 1;
                    c.blur_reach = 0;
                    c.newest = 1.0F;
                  },
                  true},
};

}  // namespace

std::span<const CullingMethod> culling_methods() {
  return kMethods;
}

Result<const CullingMethod*> find_culling_method(const std::string& name) {
  std::string names;
  for (const CullingMethod& method : kMethods) {
    if (method.name == name) return &method;
    names += (names.empty() ? "" : ", ") + std::string(method.name);
  }
  return base::bad_input("unknown method '" + name + "'", "--methods", "allowed: " + names);
}

Config culling_config(const CullingMethod& method, int kept) {
  kernels::KernelOptions options;
  options.jitter = false;
  options.ambient_samples = 0;
  options.lambert_only = true;
  Config config = kernels::culling::make_config(options);
  config.kept = kept;
  config.importance.acuity.inner = CullingSetting::fovea();
  method.set(config);
  return config;
}

}  // namespace macula::bench
