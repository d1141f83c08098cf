#include "client/display/openxr/xr_values.h"

#include <openxr/openxr_reflection.h>

namespace macula::display {

Pose from_xr(const XrPosef& pose) {
  const XrQuaternionf& q = pose.orientation;
  // Floats are a unit length to seven digits only; poses want it to double's.
  return {{pose.position.x, pose.position.y, pose.position.z},
          glm::normalize(DQuat(q.w, q.x, q.y, q.z))};
}

XrPosef to_xr(const Pose& pose) {
  const auto narrow = [](double value) { return static_cast<float>(value); };
  const DQuat& q = pose.rotation;
  const DVec3& p = pose.position;
  return {{narrow(q.x), narrow(q.y), narrow(q.z), narrow(q.w)},
          {narrow(p.x), narrow(p.y), narrow(p.z)}};
}

Fov from_xr(const XrFovf& fov) {
  return {Radians{fov.angleLeft}, Radians{fov.angleRight}, Radians{fov.angleUp},
          Radians{fov.angleDown}};
}

XrFovf to_xr(const Fov& fov) {
  return {static_cast<float>(fov.left.value()), static_cast<float>(fov.right.value()),
          static_cast<float>(fov.up.value()), static_cast<float>(fov.down.value())};
}

std::string name(XrResult result) {
  switch (result) {
#define MACULA_RESULT_NAME(enumerator, number) \
  case enumerator:                             \
    return #enumerator;
    XR_LIST_ENUM_XrResult(MACULA_RESULT_NAME)
#undef MACULA_RESULT_NAME
  }
  return "XrResult " + std::to_string(static_cast<int>(result));
}

tl::unexpected<Error> xr_error(XrResult result, const std::string& what,
                               const std::string& remedy) {
  return base::runtime_error(what + ": " + name(result), "OpenXR", remedy);
}

Result<void> check_xr(XrResult result, const std::string& what, const std::string& remedy) {
  if (XR_SUCCEEDED(result)) return {};
  return xr_error(result, what, remedy);
}

bool is_lost(XrResult result) {
  return result == XR_ERROR_SESSION_LOST || result == XR_ERROR_INSTANCE_LOST ||
         result == XR_ERROR_RUNTIME_FAILURE || result == XR_SESSION_LOSS_PENDING;
}

}  // namespace macula::display
