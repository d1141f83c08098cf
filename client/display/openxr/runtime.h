// Runtime: the instance, what it can do, the head-mounted display it drives, and its clock.
// Internal to this room.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "client/display/gl/picture_space.h"
#include "client/display/openxr/openxr.h"
#include "shared/base/result.h"
#include "shared/units/time.h"

namespace macula::display {

class Runtime {
 public:
  static Result<std::unique_ptr<Runtime>> create();
  ~Runtime();
  Runtime(const Runtime&) = delete;
  Runtime& operator=(const Runtime&) = delete;

  XrInstance instance() const { return instance_; }
  XrSystemId system() const { return system_; }
  const std::string& description() const { return description_; }
  /// Extensions in force, and for the gaze the system's word too.
  bool takes_depth() const { return takes_depth_; }
  bool tracks_gaze() const { return tracks_gaze_; }
  PictureSize recommended_px() const { return recommended_px_; }
  PictureSize largest_px() const { return largest_px_; }

  /// A function of an extension; null where the runtime lacks it.
  template <class Function>
  Function function(const char* name) const {
    PFN_xrVoidFunction found = nullptr;
    xrGetInstanceProcAddr(instance_, name, &found);
    return reinterpret_cast<Function>(found);
  }

  XrTime to_xr(ClientTime at) const;
  ClientTime from_xr(XrTime at) const;

 private:
  Runtime() = default;
  Result<void> find_system();
  Result<void> find_sizes();
  Result<void> find_clock();

  XrInstance instance_ = XR_NULL_HANDLE;
  XrSystemId system_ = XR_NULL_SYSTEM_ID;
  std::string description_;
  bool takes_depth_ = false, tracks_gaze_ = false;
  PictureSize recommended_px_, largest_px_;
  PFN_xrConvertTimespecTimeToTimeKHR from_timespec_ = nullptr;
  PFN_xrConvertTimeToTimespecTimeKHR to_timespec_ = nullptr;
};

}  // namespace macula::display
