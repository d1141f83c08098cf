// The last rung of a failing link: the world stands still, reprojected rightly, and a badge says
// for how long. One thread.
#pragma once

#include <string>

#include "shared/image/color.h"
#include "shared/image/plane.h"
#include "shared/units/time.h"

namespace macula::client_app {

/// Frames older than this are marked; a server that is there makes newer ones.
inline constexpr Nanoseconds kBadgeAfter = std::chrono::milliseconds{700};

/// "1.2 s old"; empty while nothing is amiss.
std::string age_badge(Nanoseconds age);
/// In the middle of the upper third, sized with the picture; nothing while nothing is amiss.
void draw_age_badge(image::Plane<Rgb8>& picture, Nanoseconds age);

}  // namespace macula::client_app
