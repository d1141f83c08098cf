// Settings of kernel `lightcuts`: kernel `ray`'s tiles, with the lights of a cut in place of every
// light. README.md in this folder has the method in one screen.
#pragma once

#include "server/kernels/ray/config.h"

namespace macula::kernels::lightcuts {

/// KernelOptions::area_light_samples is the most nodes of a cut, over all lights that have a place.
inline ray::Config make_config(const KernelOptions& options) {
  ray::Config config = ray::make_config(options);
  config.lights = ray::LightChoice::ByCut;
  return config;
}

}  // namespace macula::kernels::lightcuts
