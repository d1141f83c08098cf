// What every kernel understands; each kernel's own Config refines it.
#pragma once

#include <optional>

namespace macula::kernels {

/// Exact is unbiased and keeps no history (what tests use); Fast may take every shortcut it
/// reports.
enum class Mode { Exact, Fast };

/// Whether mode Fast may take cells from earlier frames instead of tracing them; kernel `ray` only.
enum class Reuse { Nothing, EarlierFrames };

/// Whether mode Fast asks as many lights everywhere, or as many as the eye would see the difference
/// (then area_light_samples is not used); kernel `lightcuts` only.
enum class LightShare { Uniform, Perceived };

struct KernelOptions {
  Mode mode = Mode::Fast;
  int samples_per_cell = 1;     ///< n; a square number gives a regular n = k x k pattern
  bool jitter = true;           ///< false: fixed sample positions (k x k centres)
  int area_light_samples = 8;   ///< per primary sample, over all emissive triangles
  int ambient_samples = 4;      ///< per primary sample; 0 = no ambient term
  int environment_samples = 4;  ///< per primary sample, in a scene with an environment
  /// Of indirect light; none: the kernel's own number, 1 for `culling` and 0 for others.
  std::optional<int> bounces;
  bool lambert_only = false;  ///< every material becomes Lambert with its base colour
  Reuse reuse = Reuse::Nothing;
  LightShare light_share = LightShare::Uniform;
};

}  // namespace macula::kernels
