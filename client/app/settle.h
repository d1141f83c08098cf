// Settling: what is shown when frames stop coming. A frame that is long past its time is not
// carried on for ever: the eye's place eases back to where the frame was rendered from, where the
// warp invents nothing, and the picture darkens towards its rim. Turns of the head go on being
// followed, so the world stays where it is. One thread.
#pragma once

#include "shared/image/color.h"
#include "shared/image/plane.h"
#include "shared/math/pose.h"
#include "shared/units/time.h"

namespace macula::client_app {

/// A frame is carried on in full for so long after it came; then it settles within kSettleTime.
inline constexpr Nanoseconds kSettleAfter = std::chrono::milliseconds{700};
inline constexpr Nanoseconds kSettleTime = std::chrono::milliseconds{600};

/// 0: carried on in full, 1: settled; rises smoothly with the age.
double settled_share(Nanoseconds age);
/// The display's pose for a share: its turn, and its place between the display's and the frame's.
Pose settled_pose(const Pose& stage_from_display, const Pose& stage_from_frame, double share);
/// Darkens the rim, the corners by half of `share`; the middle stays.
void draw_vignette(image::Plane<Rgb8>& picture, double share);

}  // namespace macula::client_app
