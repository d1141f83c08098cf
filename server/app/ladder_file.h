// Reads a kernel's quality ladder, as `macula-bench tradeoff --ladders` writes them: TOML with
//   kernel = "ray"
//   scenes = ["posts"]          # what it was measured on
//   [[step]]                    # two or more, by rising quality
//   quality = 0.0               # 0 .. 10
//   scale = 0.2                 # of the periphery's resolution, (0, 1]
//   knobs = "lights=1"          # of the kernel, over its options; "" for none
//   cost = 0.03                 # of a frame, over the dearest step's
//   rmse = 0.04                 # display-linear, as the eye weighs it
#pragma once

#include <string>

#include "server/session/quality_ladder.h"
#include "shared/base/result.h"

namespace macula::server_app {

struct LadderFile {
  std::string kernel;
  session::QualityLadder ladder = session::QualityLadder::of_scale();
};

/// Errors name the file, the line and what is allowed.
Result<LadderFile> load_ladder_file(const std::string& path);

}  // namespace macula::server_app
