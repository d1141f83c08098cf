// The one visible table of kernels: {name, what it requires of a scene, make}.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "server/kernels/kernel.h"
#include "shared/base/result.h"

namespace macula::kernels {

/// Exact is unbiased and keeps no history (what tests use); Fast may take every shortcut it reports.
enum class Mode { Exact, Fast };

/// What every kernel understands; each kernel's own Config refines it.
struct KernelOptions {
  Mode mode = Mode::Fast;
  int samples_per_cell = 1;        ///< n; a square number gives a regular n = k x k pattern
  bool jitter = true;              ///< false: fixed sample positions (k x k centres)
  int area_light_samples = 8;      ///< per primary sample, over all emissive triangles
  int ambient_samples = 4;         ///< per primary sample; 0 = no ambient term
  int bounces = 0;                 ///< diffuse bounces by path tracing; brute force only
  bool lambert_only = false;       ///< every material becomes Lambert with its base colour
};

struct KernelEntry {
  std::string_view name;
  std::string_view requires_of_scene;
  std::unique_ptr<Kernel> (*make)(const KernelOptions& options);
};
std::span<const KernelEntry> kernel_table();
/// "auto" is resolved by ScenePlan before this; an unknown name answers with the list of names.
Result<std::unique_ptr<Kernel>> make_kernel(std::string_view name, const KernelOptions& options);

}  // namespace macula::kernels
