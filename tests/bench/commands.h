// The command line of every experiment: each declare_ adds its options to its subcommand and
// returns what to do once the command line has been read.
#pragma once

#include <functional>

#include "shared/base/result.h"

namespace CLI {
class App;
}

namespace macula::bench {

using Run = std::function<Result<void>()>;

/// Quick where --quick stands on the command line: it changes what options are when nobody gives
/// them, so it is known before any is read.
enum class Pace { Full, Quick };

Run declare_compare(CLI::App& command, Pace pace);
Run declare_still(CLI::App& command, Pace pace);
Run declare_contact_sheet(CLI::App& command, Pace pace);
Run declare_culling(CLI::App& command, Pace pace);
Run declare_motion(CLI::App& command, Pace pace);
Run declare_lightcuts(CLI::App& command, Pace pace);
Run declare_light_tree(CLI::App& command, Pace pace);
Run declare_sphere(CLI::App& command, Pace pace);
Run declare_ray(CLI::App& command, Pace pace);
Run declare_reprojection(CLI::App& command, Pace pace);
Run declare_warp(CLI::App& command, Pace pace);
Run declare_codecs(CLI::App& command, Pace pace);
Run declare_maps(CLI::App& command, Pace pace);
Run declare_streaming(CLI::App& command, Pace pace);
Run declare_scaling(CLI::App& command, Pace pace);
Run declare_tradeoff(CLI::App& command, Pace pace);
Run declare_report(CLI::App& command, Pace pace);

}  // namespace macula::bench
