// The one visible table of kernels: {name, what it requires of a scene, make}.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "server/kernels/kernel.h"
#include "server/kernels/knobs.h"
#include "server/kernels/options.h"
#include "shared/base/result.h"

namespace macula::kernels {

/// What a scene's surfaces are described by.
enum class SceneKind { Triangles, Field, Either };

struct KernelEntry {
  std::string_view name;
  SceneKind requires_of_scene;
  int most_bounces;  ///< KernelOptions::bounces it can do
  int most_samples;  ///< KernelOptions::samples_per_cell it can do
  /// Options first, then knobs over them; errors are the knobs'.
  Result<std::unique_ptr<Kernel>> (*make)(const KernelOptions& options, const KnobValues& knobs);
};
std::span<const KernelEntry> kernel_table();
constexpr bool renders(const KernelEntry& entry, SceneKind kind) {
  return entry.requires_of_scene == SceneKind::Either || entry.requires_of_scene == kind;
}
/// "auto" is resolved by ScenePlan before this; an unknown name answers with the list of names, an
/// option out of range (counts below 1, or below 0 for ambient_samples and bounces) with the range.
/// So does a knob that the kernel has not, or a value that it does not take.
Result<std::unique_ptr<Kernel>> make_kernel(std::string_view name, const KernelOptions& options,
                                            const KnobValues& knobs = {});

/// What kernel `name`'s pictures tend to with ever more samples, one sample at a time: without
/// error but noise. Kernel sphere's lie at fixed places and err by what falls between them.
Result<std::unique_ptr<Kernel>> make_reference(std::string_view name, const KernelOptions& options);

/// Whether a kernel can render a scene: an error names the kernels that can. Unknown names pass.
Result<void> check_scene(std::string_view kernel, const scene::Scene& scene);

}  // namespace macula::kernels
