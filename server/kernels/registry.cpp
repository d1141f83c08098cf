#include "server/kernels/registry.h"

#include <array>
#include <string>

#include "server/kernels/brute.h"
#include "server/kernels/ray/ray_kernel.h"
#include "shared/base/text.h"

namespace macula::kernels {
namespace {

constexpr int kMostBounces = 1;

constexpr std::array kTable{
    KernelEntry{"ray", "triangles", 0,
                [](const KernelOptions& options) -> std::unique_ptr<Kernel> {
                  return std::make_unique<ray::RayKernel>(ray::make_config(options));
                }},
    KernelEntry{"brute", "triangles", kMostBounces,
                [](const KernelOptions& options) -> std::unique_ptr<Kernel> {
                  return std::make_unique<BruteKernel>(options);
                }},
};

std::string list_of_names() {
  std::string names;
  for (const KernelEntry& entry : kTable)
    names += (names.empty() ? "" : ", ") + std::string(entry.name);
  return names;
}

Result<void> check(const KernelEntry& entry, const KernelOptions& options) {
  const auto least = [&](int value, int limit, const char* what) -> Result<void> {
    if (value >= limit) return {};
    return base::bad_input(base::concat(what, " is ", value), std::string(entry.name),
                           base::concat("at least ", limit));
  };
  if (auto ok = least(options.samples_per_cell, 1, "samples per cell"); !ok) return ok;
  if (auto ok = least(options.area_light_samples, 1, "area light samples"); !ok) return ok;
  if (auto ok = least(options.ambient_samples, 0, "ambient samples"); !ok) return ok;
  if (auto ok = least(options.environment_samples, 1, "environment samples"); !ok) return ok;
  if (auto ok = least(options.bounces, 0, "bounces"); !ok) return ok;
  if (options.bounces > entry.most_bounces) {
    return base::bad_input(
        base::concat("bounces is ", options.bounces), std::string(entry.name),
        base::concat("this kernel does at most ", entry.most_bounces, "; kernel brute does 1"));
  }
  return {};
}

}  // namespace

std::span<const KernelEntry> kernel_table() {
  return kTable;
}

Result<std::unique_ptr<Kernel>> make_kernel(std::string_view name, const KernelOptions& options) {
  for (const KernelEntry& entry : kTable) {
    if (entry.name != name) continue;
    if (auto ok = check(entry, options); !ok) return base::forward(ok);
    return entry.make(options);
  }
  return base::bad_input(base::concat("unknown kernel '", name, "'"), "kernel",
                         "allowed: " + list_of_names());
}

}  // namespace macula::kernels
