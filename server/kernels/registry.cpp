#include "server/kernels/registry.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "server/kernels/brute.h"
#include "server/kernels/culling/culling_kernel.h"
#include "server/kernels/culling/knobs.h"
#include "server/kernels/lightcuts/knobs.h"
#include "server/kernels/lightcuts/lightcuts_kernel.h"
#include "server/kernels/ray/knobs.h"
#include "server/kernels/ray/ray_kernel.h"
#include "server/kernels/sphere/knobs.h"
#include "server/kernels/sphere/sphere_kernel.h"
#include "shared/base/text.h"

namespace macula::kernels {
namespace {

constexpr int kMostBounces = 1;
constexpr int kAnyCount = std::numeric_limits<int>::max();

using Made = Result<std::unique_ptr<Kernel>>;

/// Options, then knobs, then the kernel that holds both.
template <class AnyKernel, class Config>
Made make_turned(Config config, const KnobValues& knobs) {
  if (auto ok = turn_knobs(knobs, config); !ok) return base::forward(ok);
  return std::make_unique<AnyKernel>(config);
}

Made make_brute(const KernelOptions& options, const KnobValues& knobs) {
  if (!knobs.empty()) return tl::unexpected(unknown_knob("brute", knobs.front(), "none"));
  return std::make_unique<BruteKernel>(options);
}

constexpr std::array kTable{
    KernelEntry{"ray", SceneKind::Either, 0, kAnyCount,
                [](const KernelOptions& options, const KnobValues& knobs) {
                  return make_turned<ray::RayKernel>(ray::make_config(options), knobs);
                }},
    KernelEntry{"lightcuts", SceneKind::Either, 0, kAnyCount,
                [](const KernelOptions& options, const KnobValues& knobs) {
                  return make_turned<lightcuts::LightcutsKernel>(lightcuts::make_config(options),
                                                                 knobs);
                }},
    KernelEntry{"culling", SceneKind::Either, kMostBounces, kAnyCount,
                [](const KernelOptions& options, const KnobValues& knobs) {
                  return make_turned<culling::CullingKernel>(culling::make_config(options), knobs);
                }},
    KernelEntry{"sphere", SceneKind::Field, 0, sphere::kMostSamples,
                [](const KernelOptions& options, const KnobValues& knobs) {
                  return make_turned<sphere::SphereKernel>(sphere::make_config(options), knobs);
                }},
    KernelEntry{"brute", SceneKind::Either, kMostBounces, kAnyCount, make_brute},
};

SceneKind kind_of(const scene::Scene& scene) {
  return scene.field != nullptr ? SceneKind::Field : SceneKind::Triangles;
}

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
  if (auto ok = least(options.bounces.value_or(0), 0, "bounces"); !ok) return ok;
  if (options.samples_per_cell > entry.most_samples) {
    return base::bad_input(base::concat("samples per cell is ", options.samples_per_cell),
                           std::string(entry.name),
                           base::concat("this kernel takes at most ", entry.most_samples));
  }
  if (options.bounces.value_or(0) > entry.most_bounces) {
    return base::bad_input(base::concat("bounces is ", *options.bounces), std::string(entry.name),
                           base::concat("this kernel does at most ", entry.most_bounces,
                                        "; kernels brute and culling do 1"));
  }
  return {};
}

}  // namespace

std::span<const KernelEntry> kernel_table() {
  return kTable;
}

Result<std::unique_ptr<Kernel>> make_kernel(std::string_view name, const KernelOptions& options,
                                            const KnobValues& knobs) {
  for (const KernelEntry& entry : kTable) {
    if (entry.name != name) continue;
    if (auto ok = check(entry, options); !ok) return base::forward(ok);
    return entry.make(options, knobs);
  }
  return base::bad_input(base::concat("unknown kernel '", name, "'"), "kernel",
                         "allowed: " + list_of_names());
}

Result<std::unique_ptr<Kernel>> make_reference(std::string_view name,
                                               const KernelOptions& options) {
  KernelOptions single = options;
  single.samples_per_cell = single.area_light_samples = 1;
  single.ambient_samples = std::min(single.ambient_samples, 1);
  single.environment_samples = 1;
  single.reuse = Reuse::Nothing;
  // Its exact mode has other shadows.
  if (name == "sphere") return make_kernel(name, single, {{"foveation", "off"}});
  single.mode = Mode::Exact;
  if (name != "culling") return make_kernel(name, single);
  single.bounces = options.bounces.value_or(1);
  return make_kernel("brute", single);
}

Result<void> check_scene(std::string_view kernel, const scene::Scene& scene) {
  const SceneKind kind = kind_of(scene);
  std::string able;
  bool fits = true;
  for (const KernelEntry& entry : kTable) {
    if (renders(entry, kind)) {
      able += (able.empty() ? "" : ", ") + std::string(entry.name);
    } else if (entry.name == kernel) {
      fits = false;
    }
  }
  if (fits) return {};
  return base::bad_input(
      base::concat("kernel '", kernel, "' does not render ",
                   kind == SceneKind::Field ? "distance fields" : "scenes of triangles"),
      scene.name, "kernels that do: " + able);
}

}  // namespace macula::kernels
