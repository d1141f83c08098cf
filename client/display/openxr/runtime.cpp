#include "client/display/openxr/runtime.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <ratio>

#include "client/display/openxr/xr_values.h"
#include "shared/base/text.h"

namespace macula::display {
namespace {

constexpr const char* kNoRuntime =
    "start an OpenXR runtime (SteamVR, WiVRn, Monado) and let XR_RUNTIME_JSON name its manifest if "
    "it is not the system's own; without a headset use --display window";

using Names = std::vector<std::string>;

Result<Names> offered_extensions() {
  std::uint32_t count = 0;
  if (auto done = check_xr(xrEnumerateInstanceExtensionProperties(nullptr, 0, &count, nullptr),
                           "no runtime answers", kNoRuntime);
      !done) {
    return base::forward(done);
  }
  std::vector<XrExtensionProperties> properties(count,
                                                {XR_TYPE_EXTENSION_PROPERTIES, nullptr, {}, 0});
  if (auto done = check_xr(
          xrEnumerateInstanceExtensionProperties(nullptr, count, &count, properties.data()),
          "the runtime's extensions cannot be read", kNoRuntime);
      !done) {
    return base::forward(done);
  }
  Names names;
  for (const auto& property : properties) names.emplace_back(property.extensionName);
  return names;
}

bool contains(const Names& names, const char* wanted) {
  return std::find(names.begin(), names.end(), wanted) != names.end();
}

/// Those Macula needs and those it can use.
Result<std::vector<const char*>> wanted_extensions(const Names& offered) {
  std::vector<const char*> wanted;
  for (const char* needed :
       {XR_KHR_OPENGL_ENABLE_EXTENSION_NAME, XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME}) {
    if (!contains(offered, needed))
      return base::runtime_error(base::concat("the runtime does not offer ", needed), "OpenXR",
                                 "use another runtime, or --display window");
    wanted.push_back(needed);
  }
  for (const char* useful : {XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME,
                             XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME}) {
    if (contains(offered, useful)) wanted.push_back(useful);
  }
  return wanted;
}

Result<XrInstance> make_instance(const std::vector<const char*>& extensions) {
  auto info = xr_struct<XrInstanceCreateInfo>(XR_TYPE_INSTANCE_CREATE_INFO);
  std::strncpy(info.applicationInfo.applicationName, "Macula", XR_MAX_APPLICATION_NAME_SIZE - 1);
  std::strncpy(info.applicationInfo.engineName, "Macula", XR_MAX_ENGINE_NAME_SIZE - 1);
  info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 0);
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.enabledExtensionNames = extensions.data();
  XrInstance instance = XR_NULL_HANDLE;
  if (auto done = check_xr(xrCreateInstance(&info, &instance), "the runtime refuses", kNoRuntime);
      !done) {
    return base::forward(done);
  }
  return instance;
}

std::string version_text(XrVersion version) {
  return base::concat(XR_VERSION_MAJOR(version), ".", XR_VERSION_MINOR(version), ".",
                      XR_VERSION_PATCH(version));
}

}  // namespace

Result<std::unique_ptr<Runtime>> Runtime::create() {
  const auto offered = offered_extensions();
  if (!offered) return base::forward(offered);
  const auto wanted = wanted_extensions(*offered);
  if (!wanted) return base::forward(wanted);
  const auto instance = make_instance(*wanted);
  if (!instance) return base::forward(instance);
  auto runtime = std::unique_ptr<Runtime>(new Runtime);
  runtime->instance_ = *instance;
  runtime->takes_depth_ = contains(*offered, XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME);
  runtime->tracks_gaze_ = contains(*offered, XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME);
  for (const auto step : {&Runtime::find_system, &Runtime::find_sizes, &Runtime::find_clock}) {
    if (auto done = (runtime.get()->*step)(); !done) return base::forward(done);
  }
  return runtime;
}

Runtime::~Runtime() {
  if (instance_ != XR_NULL_HANDLE) xrDestroyInstance(instance_);
}

Result<void> Runtime::find_system() {
  auto runtime = xr_struct<XrInstanceProperties>(XR_TYPE_INSTANCE_PROPERTIES);
  if (auto done = check_xr(xrGetInstanceProperties(instance_, &runtime), "the runtime has no name");
      !done)
    return done;
  const XrSystemGetInfo info{XR_TYPE_SYSTEM_GET_INFO, nullptr, XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY};
  if (auto done = check_xr(xrGetSystem(instance_, &info, &system_),
                           base::concat(runtime.runtimeName, " has no headset"),
                           "connect and switch it on, or use --display window");
      !done)
    return done;
  auto eyes = xr_struct<XrSystemEyeGazeInteractionPropertiesEXT>(
      XR_TYPE_SYSTEM_EYE_GAZE_INTERACTION_PROPERTIES_EXT);
  auto system = xr_struct<XrSystemProperties>(XR_TYPE_SYSTEM_PROPERTIES);
  if (tracks_gaze_) system.next = &eyes;
  if (auto done = check_xr(xrGetSystemProperties(instance_, system_, &system),
                           "the headset's properties cannot be read");
      !done)
    return done;
  tracks_gaze_ = tracks_gaze_ && eyes.supportsEyeGazeInteraction == XR_TRUE;
  description_ = base::concat(runtime.runtimeName, " ", version_text(runtime.runtimeVersion), ", ",
                              system.systemName);
  return {};
}

Result<void> Runtime::find_sizes() {
  std::array<XrViewConfigurationView, 2> views;
  views.fill(xr_struct<XrViewConfigurationView>(XR_TYPE_VIEW_CONFIGURATION_VIEW));
  std::uint32_t count = 0;
  if (auto done = check_xr(xrEnumerateViewConfigurationViews(
                               instance_, system_, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO,
                               static_cast<std::uint32_t>(views.size()), &count, views.data()),
                           "the headset does not show two eyes");
      !done)
    return done;
  const auto size = [](std::uint32_t width, std::uint32_t height) {
    return PictureSize{static_cast<int>(width), static_cast<int>(height)};
  };
  recommended_px_ = size(views[0].recommendedImageRectWidth, views[0].recommendedImageRectHeight);
  largest_px_ = size(views[0].maxImageRectWidth, views[0].maxImageRectHeight);
  return {};
}

Result<void> Runtime::find_clock() {
  from_timespec_ = function<PFN_xrConvertTimespecTimeToTimeKHR>("xrConvertTimespecTimeToTimeKHR");
  to_timespec_ = function<PFN_xrConvertTimeToTimespecTimeKHR>("xrConvertTimeToTimespecTimeKHR");
  if (from_timespec_ == nullptr || to_timespec_ == nullptr)
    return base::runtime_error("the runtime does not translate its clock", "OpenXR",
                               "use another runtime, or --display window");
  return {};
}

// An XrTime has an origin of its own; a timespec here is CLOCK_MONOTONIC, as ClientTime is.

XrTime Runtime::to_xr(ClientTime at) const {
  const auto since = at.time_since_epoch().count();
  const timespec monotonic{static_cast<time_t>(since / std::nano::den),
                           static_cast<long>(since % std::nano::den)};
  XrTime time = 0;
  from_timespec_(instance_, &monotonic, &time);
  return time;
}

ClientTime Runtime::from_xr(XrTime at) const {
  timespec monotonic{};
  to_timespec_(instance_, at, &monotonic);
  return ClientTime{std::chrono::seconds{monotonic.tv_sec} + Nanoseconds{monotonic.tv_nsec}};
}

}  // namespace macula::display
