// Between OpenXR's values and ours, and from its results to errors. Internal to this room.
#pragma once

#include <string>

#include "client/display/openxr/openxr.h"
#include "shared/base/result.h"
#include "shared/math/fov.h"
#include "shared/math/pose.h"

namespace macula::display {

Pose from_xr(const XrPosef& pose);
XrPosef to_xr(const Pose& pose);
Fov from_xr(const XrFovf& fov);
XrFovf to_xr(const Fov& fov);

inline XrPosef identity_pose() {
  return {{0.0F, 0.0F, 0.0F, 1.0F}, {0.0F, 0.0F, 0.0F}};
}

/// The result's name in the specification, such as "XR_ERROR_SESSION_LOST".
std::string name(XrResult result);
/// "what: XR_ERROR_..." with the remedy.
tl::unexpected<Error> xr_error(XrResult result, const std::string& what,
                               const std::string& remedy = {});
/// An Error unless the call succeeded.
Result<void> check_xr(XrResult result, const std::string& what, const std::string& remedy = {});
/// The runtime or the session is gone for good.
bool is_lost(XrResult result);

}  // namespace macula::display
