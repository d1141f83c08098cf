// The kernel that the options ask for, and its quality ladder: the same kernel once for every step,
// its knobs turned.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/app/options.h"
#include "server/kernels/kernel.h"
#include "server/session/quality_ladder.h"
#include "shared/base/result.h"

namespace macula::server_app {

/// Kernel `name` as the options have it. Errors: those of kernels::make_kernel, and of --knobs.
Result<std::unique_ptr<kernels::Kernel>> choose_kernel(const Options& options,
                                                       const std::string& name);

/// Empty: the periphery's resolution alone gives way.
struct Ladder {
  std::shared_ptr<const session::QualityLadder> steps;
  std::vector<std::shared_ptr<const kernels::Kernel>> kernels;  ///< at each of the steps
  std::shared_ptr<const kernels::Kernel> reference;             ///< what frames are judged by
};

/// That of the kernel where a goal asks for one, from --ladders or the `installed` folder; empty
/// where there is none, which is told. Errors name the file, or the option that needs it.
Result<Ladder> load_ladder(const Options& options, const std::string& installed,
                           const std::string& kernel);
/// To standard output: where on it frames begin, and what its floor is.
void print_ladder(const Ladder& ladder, const Options& options);

}  // namespace macula::server_app
