// Values that the command line gives as text: sizes, points, cameras. An error names the option,
// shows what was given and says what is allowed.
#pragma once

#include <string>

#include "shared/base/result.h"
#include "shared/foveation/rate.h"
#include "shared/math/vec.h"
#include "tests/bench/still.h"

namespace macula::bench {

struct PictureSize {
  int width_px = 0, height_px = 0;
};

/// "640x480", 1..16384 a side.
Result<PictureSize> parse_size(const std::string& option, const std::string& text);
/// "a,b": two finite numbers.
Result<DVec2> parse_pair(const std::string& option, const std::string& text);
/// "inner,outer,floor": a ramp of rates, 0 <= inner < outer <= 180 degrees, floor in (0, 1].
Result<foveation::RateModel> parse_ramp(const std::string& option, const std::string& text);
/// "yaw,pitch" in degrees, within 180 and 90.
Result<StillGaze> parse_gaze(const std::string& option, const std::string& text);
/// "ex,ey,ez;tx,ty,tz;ux,uy,uz;vfov": eye and target apart, up not along the view, vfov in (0,
/// 180).
Result<StillCamera> parse_camera(const std::string& option, const std::string& text);

}  // namespace macula::bench
