#include "tests/bench/culling_method.h"

#include <array>
#include <limits>

#include "shared/base/text.h"
#include "tests/bench/culling_setting.h"

namespace macula::bench {
namespace {

using kernels::culling::Config;
using kernels::culling::Hiding;
using kernels::culling::KeptBy;
using kernels::culling::Space;

/// As the paper has it, but for weights, shadow rays and where and how contributions are told.
void set_paper(Config& c) {
  c.hiding = Hiding::LampMaps;
  c.space = Space::LogPolar;
}

/// Every pixel asks, not one in eight.
constexpr double kInEveryPixel = 1.0 / 8.0;

constexpr std::array kMethods{
    CullingMethod{"flc", "contributions by BLSO, log-polar, 4 x 4 classes, as the paper",
                  set_paper},
    CullingMethod{"flc_no_blso", "flc, contributions as if nothing were hidden",
                  [](Config& c) {
                    set_paper(c);
                    c.hiding = Hiding::Nothing;
                  }},
    CullingMethod{"flc_no_logpolar", "flc, light asked in every pixel",
                  [](Config& c) {
                    set_paper(c);
                    c.space = Space::Cells;
                  },
                  Rendering::Picture, kInEveryPixel},
    CullingMethod{"flc_no_classes", "flc_no_logpolar, every pixel asks every kept light",
                  [](Config& c) {
                    set_paper(c);
                    c.space = Space::Cells;
                    c.classes = 1;
                    c.blur_reach = 0;
                  },
                  Rendering::Fourth},
    CullingMethod{"flc_literal", "flc as printed: unweighted, unshadowed, best of a chain",
                  [](Config& c) {
                    set_paper(c);
                    c.weights = kernels::culling::CullWeights::None;
                    c.shadows = kernels::ray::VirtualShadows::None;
                    c.points = kernels::culling::PointDraw::PrintedChain;
                    c.by_flux = 0.0F, c.points_in_fovea = 0.0F, c.rings = 4.0;
                    c.mean = kernels::culling::PointMean::Plain;
                    c.importance.brightness_floor = 0.0F;
                  }},
    CullingMethod{"flc_rays", "contributions by rays, light asked in every pixel", [](Config&) {},
                  Rendering::Picture, kInEveryPixel},
    CullingMethod{"flc_some", "flc_rays, 8 rays a pixel, drawn by what lights would bring",
                  [](Config& c) { c.asked = 8; }},
    CullingMethod{
        "flc_fast",
        "the kernel's own, no picture memory: flc_some in every second pixel each way, 4 classes",
        [](Config& c) {
          c.asked = 8;
          c.classes = 4;
          c.space = Space::Thinned;
        }},
    CullingMethod{"fir", "foveated instant radiosity: lights from the camera",
                  [](Config& c) {
                    set_paper(c);
                    c.source = kernels::culling::LightSource::Camera;
                    c.importance.silhouette = 0.0F, c.points_in_fovea = 0.0F;
                  }},
    CullingMethod{"power", "flc, kept by flux",
                  [](Config& c) {
                    set_paper(c);
                    c.kept_by = KeptBy::Flux;
                  }},
    CullingMethod{"tree", "cuts of a light tree, sized by the importance map",
                  [](Config& c) { c.route = kernels::culling::Route::Cuts; }, Rendering::Picture,
                  kInEveryPixel},
    CullingMethod{"all_vpls", "every light from every pixel, a shadow ray each",
                  [](Config& c) {
                    c.kept = std::numeric_limits<int>::max();
                    c.classes = 1;
                    c.blur_reach = 0;
                    c.newest = 1.0F;
                  },
                  Rendering::Blocks},
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
  config.ray.footprints = kernels::ray::Footprints::Points;  // as the reference's
  config.classes = 16, config.asked = 0, config.space = Space::Cells;
  config.kept = kept;
  config.picture_frames = 1;
  config.importance.acuity.inner = CullingSetting::fovea();
  method.set(config);
  return config;
}

}  // namespace macula::bench
