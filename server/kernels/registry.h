// The one visible table of kernels: {name, what it requires of a scene, make}.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "server/kernels/kernel.h"
#include "server/kernels/options.h"
#include "shared/base/result.h"

namespace macula::kernels {

struct KernelEntry {
  std::string_view name;
  std::string_view requires_of_scene;
  int most_bounces;  ///< KernelOptions::bounces it can do
  std::unique_ptr<Kernel> (*make)(const KernelOptions& options);
};
std::span<const KernelEntry> kernel_table();
/// "auto" is resolved by ScenePlan before this; an unknown name answers with the list of names, an
/// option out of range (counts below 1, or below 0 for ambient_samples and bounces) with the range.
Result<std::unique_ptr<Kernel>> make_kernel(std::string_view name, const KernelOptions& options);

}  // namespace macula::kernels
