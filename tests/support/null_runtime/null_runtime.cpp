#include "tests/support/null_runtime/null_runtime.h"

#include <epoxy/gl.h>

#define XR_USE_PLATFORM_XLIB
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_TIMESPEC
#define __gl_h_  // epoxy declares it all
#include <GL/glx.h>
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <deque>
#include <map>
#include <thread>

namespace macula::test {
namespace {

NullRuntime runtime;

// The loader of Debian 12 ships no header for its negotiation; these are the specification's.
struct NegotiateLoaderInfo {
  int structType;
  std::uint32_t structVersion;
  std::size_t structSize;
  std::uint32_t minInterfaceVersion, maxInterfaceVersion;
  XrVersion minApiVersion, maxApiVersion;
};
struct NegotiateRuntimeRequest {
  int structType;
  std::uint32_t structVersion;
  std::size_t structSize;
  std::uint32_t runtimeInterfaceVersion;
  XrVersion runtimeApiVersion;
  PFN_xrGetInstanceProcAddr getInstanceProcAddr;
};

enum class SpaceKind { Stage, Head, Gaze };
struct Space {
  SpaceKind kind;
};
struct Swapchain {
  int width = 0, height = 0;
  bool depth = false;
  std::array<GLuint, 3> textures{};
  std::uint32_t next = 0;
  bool acquired = false;
};

/// One session at a time is all a test needs.
struct State {
  XrSessionState session = XR_SESSION_STATE_UNKNOWN;
  std::deque<XrSessionState> events;
  bool begun = false, in_frame = false, waited = false;
  std::uint64_t frame = 0;  ///< frames waited for
  std::chrono::steady_clock::time_point next_frame;
  std::vector<std::string> paths;
} state;

// Handles are pointers or small numbers that only have to differ from null.
template <class Handle>
Handle handle_of(void* pointer) {
  return reinterpret_cast<Handle>(pointer);
}
int token = 0;

std::lock_guard<std::mutex> lock() {
  return std::lock_guard(runtime.mutex);
}

XrResult misuse(const std::string& what) {
  const auto held = lock();
  if (++runtime.misuses == 1) runtime.first_misuse = what;
  return XR_ERROR_CALL_ORDER_INVALID;
}

void count_handle(int change) {
  const auto held = lock();
  runtime.live_handles += change;
}

bool is_lost() {
  return runtime.script.lose_at_frame > 0 && state.frame >= runtime.script.lose_at_frame;
}

void announce(XrSessionState next) {
  state.session = next;
  state.events.push_back(next);
}

template <class Keys>
auto key_at(const Keys& keys, std::uint64_t frame) {
  auto found = keys.front();
  for (const auto& key : keys)
    if (key.from_frame <= frame) found = key;
  return found;
}

XrPosef to_xr(const NullPose& p) {
  return {{p.qx, p.qy, p.qz, p.qw}, {p.px, p.py, p.pz}};
}
NullPose from_xr(const XrPosef& p) {
  return {p.position.x,    p.position.y,    p.position.z,   p.orientation.x,
          p.orientation.y, p.orientation.z, p.orientation.w};
}

/// a_from_b * b_from_c.
XrPosef compose(const XrPosef& a, const XrPosef& b) {
  const auto [x, y, z, w] = a.orientation;
  const auto rotate = [&](const XrVector3f& v) {
    const float tx = 2 * (y * v.z - z * v.y), ty = 2 * (z * v.x - x * v.z),
                tz = 2 * (x * v.y - y * v.x);
    return XrVector3f{v.x + w * tx + y * tz - z * ty, v.y + w * ty + z * tx - x * tz,
                      v.z + w * tz + x * ty - y * tx};
  };
  const XrQuaternionf& q = b.orientation;
  const XrVector3f moved = rotate(b.position);
  return {{w * q.x + x * q.w + y * q.z - z * q.y, w * q.y - x * q.z + y * q.w + z * q.x,
           w * q.z + x * q.y - y * q.x + z * q.w, w * q.w - x * q.x - y * q.y - z * q.z},
          {a.position.x + moved.x, a.position.y + moved.y, a.position.z + moved.z}};
}

XrPosef head_now() {
  return to_xr(key_at(runtime.script.heads, state.frame).stage_from_head);
}

/// The two calls of every enumeration: how many, then which.
template <class T, class Fill>
XrResult enumerate(std::uint32_t capacity, std::uint32_t* count, T* out, std::uint32_t available,
                   const Fill& fill) {
  *count = available;
  if (capacity == 0) return XR_SUCCESS;
  if (capacity < available) return XR_ERROR_SIZE_INSUFFICIENT;
  for (std::uint32_t i = 0; i < available; ++i) fill(i, out[i]);
  return XR_SUCCESS;
}

// ---- instance ----

XrResult XRAPI_CALL enumerate_extensions(const char*, std::uint32_t capacity, std::uint32_t* count,
                                         XrExtensionProperties* out) {
  std::vector<const char*> names{XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME};
  if (runtime.script.offers_opengl) names.push_back(XR_KHR_OPENGL_ENABLE_EXTENSION_NAME);
  if (runtime.script.offers_depth) names.push_back(XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME);
  if (!runtime.script.gazes.empty()) names.push_back(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME);
  return enumerate(capacity, count, out, static_cast<std::uint32_t>(names.size()),
                   [&](std::uint32_t i, XrExtensionProperties& property) {
                     std::strncpy(property.extensionName, names[i], XR_MAX_EXTENSION_NAME_SIZE - 1);
                     property.extensionVersion = 1;
                   });
}

XrResult XRAPI_CALL create_instance(const XrInstanceCreateInfo*, XrInstance* instance) {
  state = State{};
  count_handle(1);
  *instance = handle_of<XrInstance>(&token);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL destroy_instance(XrInstance) {
  count_handle(-1);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL get_instance_properties(XrInstance, XrInstanceProperties* properties) {
  std::strncpy(properties->runtimeName, "Macula's null runtime", XR_MAX_RUNTIME_NAME_SIZE - 1);
  properties->runtimeVersion = XR_MAKE_VERSION(1, 2, 3);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL get_system(XrInstance, const XrSystemGetInfo*, XrSystemId* system) {
  if (!runtime.script.has_headset) return XR_ERROR_FORM_FACTOR_UNAVAILABLE;
  *system = 1;
  return XR_SUCCESS;
}
XrResult XRAPI_CALL get_system_properties(XrInstance, XrSystemId, XrSystemProperties* properties) {
  std::strncpy(properties->systemName, "Null headset", XR_MAX_SYSTEM_NAME_SIZE - 1);
  for (auto* next = static_cast<XrBaseOutStructure*>(properties->next); next != nullptr;
       next = next->next) {
    if (next->type == XR_TYPE_SYSTEM_EYE_GAZE_INTERACTION_PROPERTIES_EXT)
      reinterpret_cast<XrSystemEyeGazeInteractionPropertiesEXT*>(next)->supportsEyeGazeInteraction =
          runtime.script.gazes.empty() ? XR_FALSE : XR_TRUE;
  }
  return XR_SUCCESS;
}
XrResult XRAPI_CALL enumerate_views(XrInstance, XrSystemId, XrViewConfigurationType,
                                    std::uint32_t capacity, std::uint32_t* count,
                                    XrViewConfigurationView* out) {
  return enumerate(capacity, count, out, 2, [](std::uint32_t, XrViewConfigurationView& view) {
    view.recommendedImageRectWidth = static_cast<std::uint32_t>(runtime.script.width_px);
    view.recommendedImageRectHeight = static_cast<std::uint32_t>(runtime.script.height_px);
    view.maxImageRectWidth = view.maxImageRectHeight =
        static_cast<std::uint32_t>(runtime.script.most_px);
    view.recommendedSwapchainSampleCount = view.maxSwapchainSampleCount = 1;
  });
}
XrResult XRAPI_CALL get_opengl_requirements(XrInstance, XrSystemId,
                                            XrGraphicsRequirementsOpenGLKHR* requirements) {
  requirements->minApiVersionSupported = XR_MAKE_VERSION(3, 0, 0);
  requirements->maxApiVersionSupported = XR_MAKE_VERSION(4, 6, 0);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL time_from_timespec(XrInstance, const timespec* at, XrTime* time) {
  *time = at->tv_sec * 1'000'000'000LL + at->tv_nsec + kTimeOffset_ns;
  return XR_SUCCESS;
}
XrResult XRAPI_CALL timespec_from_time(XrInstance, XrTime time, timespec* at) {
  const std::int64_t monotonic = time - kTimeOffset_ns;
  *at = {static_cast<time_t>(monotonic / 1'000'000'000),
         static_cast<long>(monotonic % 1'000'000'000)};
  return XR_SUCCESS;
}

XrResult XRAPI_CALL poll_event(XrInstance, XrEventDataBuffer* event) {
  if (is_lost()) return XR_ERROR_INSTANCE_LOST;
  if (state.events.empty()) return XR_EVENT_UNAVAILABLE;
  auto& changed = reinterpret_cast<XrEventDataSessionStateChanged&>(*event);
  changed = {XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED, nullptr, handle_of<XrSession>(&token),
             state.events.front(), 0};
  state.events.pop_front();
  return XR_SUCCESS;
}

// ---- session ----

XrResult XRAPI_CALL create_session(XrInstance, const XrSessionCreateInfo* info,
                                   XrSession* session) {
  const auto* binding = static_cast<const XrGraphicsBindingOpenGLXlibKHR*>(info->next);
  if (binding == nullptr || binding->type != XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR ||
      binding->glxContext == nullptr || binding->glxFBConfig == nullptr)
    return XR_ERROR_GRAPHICS_DEVICE_INVALID;
  count_handle(1);
  *session = handle_of<XrSession>(&token);
  announce(XR_SESSION_STATE_IDLE);
  announce(XR_SESSION_STATE_READY);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL destroy_session(XrSession) {
  count_handle(-1);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL begin_session(XrSession, const XrSessionBeginInfo*) {
  if (state.session != XR_SESSION_STATE_READY) return misuse("xrBeginSession before READY");
  state.begun = true;
  state.next_frame = std::chrono::steady_clock::now();
  for (const auto next :
       {XR_SESSION_STATE_SYNCHRONIZED, XR_SESSION_STATE_VISIBLE, XR_SESSION_STATE_FOCUSED})
    announce(next);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL request_exit(XrSession) {
  if (!state.begun) return XR_ERROR_SESSION_NOT_RUNNING;
  if (state.session != XR_SESSION_STATE_STOPPING) announce(XR_SESSION_STATE_STOPPING);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL end_session(XrSession) {
  if (state.session != XR_SESSION_STATE_STOPPING) return misuse("xrEndSession before STOPPING");
  state.begun = false;
  announce(XR_SESSION_STATE_IDLE);
  announce(XR_SESSION_STATE_EXITING);
  return XR_SUCCESS;
}

// ---- spaces and actions ----

XrResult make_space(SpaceKind kind, XrSpace* space) {
  count_handle(1);
  *space = handle_of<XrSpace>(new Space{kind});
  return XR_SUCCESS;
}
XrResult XRAPI_CALL create_reference_space(XrSession, const XrReferenceSpaceCreateInfo* info,
                                           XrSpace* space) {
  if (info->referenceSpaceType == XR_REFERENCE_SPACE_TYPE_VIEW)
    return make_space(SpaceKind::Head, space);
  if (info->referenceSpaceType == XR_REFERENCE_SPACE_TYPE_STAGE && !runtime.script.has_stage)
    return XR_ERROR_REFERENCE_SPACE_UNSUPPORTED;
  return make_space(SpaceKind::Stage, space);
}
XrResult XRAPI_CALL destroy_space(XrSpace space) {
  count_handle(-1);
  delete reinterpret_cast<Space*>(space);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL locate_space(XrSpace space, XrSpace, XrTime time, XrSpaceLocation* location) {
  if (is_lost()) return XR_ERROR_SESSION_LOST;
  if (time < kTimeOffset_ns) return misuse("a time of another clock");
  // As a simulated headset does: valid, but not tracked.
  location->locationFlags =
      XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT;
  if (reinterpret_cast<Space*>(space)->kind != SpaceKind::Gaze) {
    location->pose = head_now();
    return XR_SUCCESS;
  }
  location->pose = to_xr(key_at(runtime.script.gazes, state.frame).head_from_gaze);
  for (auto* next = static_cast<XrBaseOutStructure*>(location->next); next != nullptr;
       next = next->next) {
    constexpr std::int64_t kTrackerDelay_ns = 4'000'000;
    if (next->type == XR_TYPE_EYE_GAZE_SAMPLE_TIME_EXT)
      reinterpret_cast<XrEyeGazeSampleTimeEXT*>(next)->time = time - kTrackerDelay_ns;
  }
  return XR_SUCCESS;
}
XrResult XRAPI_CALL string_to_path(XrInstance, const char* text, XrPath* path) {
  state.paths.emplace_back(text);
  *path = state.paths.size();
  return XR_SUCCESS;
}
XrResult XRAPI_CALL create_action_set(XrInstance, const XrActionSetCreateInfo*, XrActionSet* set) {
  count_handle(1);
  *set = handle_of<XrActionSet>(&token);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL destroy_action_set(XrActionSet) {
  count_handle(-1);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL create_action(XrActionSet, const XrActionCreateInfo*, XrAction* action) {
  *action = handle_of<XrAction>(&token);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL suggest_bindings(XrInstance, const XrInteractionProfileSuggestedBinding* all) {
  const auto is = [](XrPath path, const char* text) {
    return path >= 1 && path <= state.paths.size() && state.paths[path - 1] == text;
  };
  const bool right =
      is(all->interactionProfile, "/interaction_profiles/ext/eye_gaze_interaction") &&
      all->countSuggestedBindings == 1 &&
      is(all->suggestedBindings[0].binding, "/user/eyes_ext/input/gaze_ext/pose");
  return right ? XR_SUCCESS : XR_ERROR_PATH_UNSUPPORTED;
}
XrResult XRAPI_CALL attach_action_sets(XrSession, const XrSessionActionSetsAttachInfo*) {
  return XR_SUCCESS;
}
XrResult XRAPI_CALL create_action_space(XrSession, const XrActionSpaceCreateInfo*, XrSpace* space) {
  return make_space(SpaceKind::Gaze, space);
}
XrResult XRAPI_CALL sync_actions(XrSession, const XrActionsSyncInfo*) {
  return state.session == XR_SESSION_STATE_FOCUSED ? XR_SUCCESS : XR_SESSION_NOT_FOCUSED;
}
XrResult XRAPI_CALL get_action_state_pose(XrSession, const XrActionStateGetInfo*,
                                          XrActionStatePose* pose) {
  pose->isActive = key_at(runtime.script.gazes, state.frame).tracked ? XR_TRUE : XR_FALSE;
  return XR_SUCCESS;
}

// ---- swapchains ----

XrResult XRAPI_CALL enumerate_formats(XrSession, std::uint32_t capacity, std::uint32_t* count,
                                      std::int64_t* out) {
  static constexpr std::array<std::int64_t, 3> kFormats{GL_RGBA16F, GL_SRGB8_ALPHA8,
                                                        GL_DEPTH_COMPONENT32F};
  return enumerate(capacity, count, out, static_cast<std::uint32_t>(kFormats.size()),
                   [](std::uint32_t i, std::int64_t& format) { format = kFormats[i]; });
}
XrResult XRAPI_CALL create_swapchain(XrSession, const XrSwapchainCreateInfo* info,
                                     XrSwapchain* handle) {
  auto* swapchain = new Swapchain;
  swapchain->width = static_cast<int>(info->width);
  swapchain->height = static_cast<int>(info->height);
  swapchain->depth = info->format == GL_DEPTH_COMPONENT32F;
  glGenTextures(static_cast<GLsizei>(swapchain->textures.size()), swapchain->textures.data());
  for (const GLuint texture : swapchain->textures) {
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(info->format), swapchain->width,
                 swapchain->height, 0, swapchain->depth ? GL_DEPTH_COMPONENT : GL_RGBA,
                 swapchain->depth ? GL_FLOAT : GL_UNSIGNED_BYTE, nullptr);
  }
  count_handle(1);
  *handle = handle_of<XrSwapchain>(swapchain);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL destroy_swapchain(XrSwapchain handle) {
  auto* swapchain = reinterpret_cast<Swapchain*>(handle);
  glDeleteTextures(static_cast<GLsizei>(swapchain->textures.size()), swapchain->textures.data());
  delete swapchain;
  count_handle(-1);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL enumerate_images(XrSwapchain handle, std::uint32_t capacity,
                                     std::uint32_t* count, XrSwapchainImageBaseHeader* out) {
  const auto& textures = reinterpret_cast<Swapchain*>(handle)->textures;
  return enumerate(
      capacity, count, reinterpret_cast<XrSwapchainImageOpenGLKHR*>(out),
      static_cast<std::uint32_t>(textures.size()),
      [&](std::uint32_t i, XrSwapchainImageOpenGLKHR& image) { image.image = textures[i]; });
}
XrResult XRAPI_CALL acquire_image(XrSwapchain handle, const XrSwapchainImageAcquireInfo*,
                                  std::uint32_t* index) {
  if (is_lost()) return XR_ERROR_SESSION_LOST;
  auto* swapchain = reinterpret_cast<Swapchain*>(handle);
  if (swapchain->acquired) return misuse("an image acquired twice");
  swapchain->acquired = true;
  swapchain->next = (swapchain->next + 1) % static_cast<std::uint32_t>(swapchain->textures.size());
  *index = swapchain->next;
  return XR_SUCCESS;
}
XrResult XRAPI_CALL wait_image(XrSwapchain handle, const XrSwapchainImageWaitInfo*) {
  return reinterpret_cast<Swapchain*>(handle)->acquired ? XR_SUCCESS
                                                        : misuse("a wait for no image");
}
XrResult XRAPI_CALL release_image(XrSwapchain handle, const XrSwapchainImageReleaseInfo*) {
  auto* swapchain = reinterpret_cast<Swapchain*>(handle);
  if (!swapchain->acquired) return misuse("an image released that was not acquired");
  swapchain->acquired = false;
  return XR_SUCCESS;
}

// ---- frames ----

XrResult XRAPI_CALL wait_frame(XrSession, const XrFrameWaitInfo*, XrFrameState* frame) {
  if (!state.begun) return XR_ERROR_SESSION_NOT_RUNNING;
  if (state.waited) return misuse("xrWaitFrame twice");
  state.waited = true;
  ++state.frame;
  if (is_lost()) return XR_ERROR_SESSION_LOST;
  if (state.frame == runtime.script.stop_at_frame) announce(XR_SESSION_STATE_STOPPING);
  using namespace std::chrono;
  const auto period = duration_cast<nanoseconds>(duration<double>(1.0 / runtime.script.refresh_hz));
  state.next_frame = std::max(state.next_frame + period, steady_clock::now());
  std::this_thread::sleep_until(state.next_frame);
  frame->predictedDisplayTime =
      (state.next_frame + period).time_since_epoch().count() + kTimeOffset_ns;
  frame->predictedDisplayPeriod = period.count();
  frame->shouldRender = state.frame > runtime.script.hidden_frames ? XR_TRUE : XR_FALSE;
  return XR_SUCCESS;
}
XrResult XRAPI_CALL begin_frame(XrSession, const XrFrameBeginInfo*) {
  if (!state.waited) return misuse("xrBeginFrame without xrWaitFrame");
  state.waited = false;
  state.in_frame = true;
  return XR_SUCCESS;
}
XrResult XRAPI_CALL locate_views(XrSession, const XrViewLocateInfo* info, XrViewState* flags,
                                 std::uint32_t capacity, std::uint32_t* count, XrView* out) {
  if (is_lost()) return XR_ERROR_SESSION_LOST;
  if (info->displayTime < kTimeOffset_ns) return misuse("a time of another clock");
  flags->viewStateFlags = XR_VIEW_STATE_ORIENTATION_VALID_BIT | XR_VIEW_STATE_POSITION_VALID_BIT;
  return enumerate(capacity, count, out, 2, [](std::uint32_t i, XrView& view) {
    view.pose = compose(head_now(), to_xr(runtime.script.head_from_eye[i]));
    const NullFov& fov = runtime.script.fov[i];
    view.fov = {fov.left, fov.right, fov.up, fov.down};
  });
}

void read_texture(const XrSwapchainSubImage& image, std::vector<std::uint8_t>& rgba) {
  const auto* swapchain = reinterpret_cast<const Swapchain*>(image.swapchain);
  rgba.resize(static_cast<std::size_t>(swapchain->width) * swapchain->height * 4);
  glBindTexture(GL_TEXTURE_2D, swapchain->textures[swapchain->next]);
  glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
}
void read_depth(const XrSwapchainSubImage& image, std::vector<float>& depth) {
  const auto* swapchain = reinterpret_cast<const Swapchain*>(image.swapchain);
  depth.resize(static_cast<std::size_t>(swapchain->width) * swapchain->height);
  glBindTexture(GL_TEXTURE_2D, swapchain->textures[swapchain->next]);
  glGetTexImage(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT, GL_FLOAT, depth.data());
}

void note_view(const XrCompositionLayerProjectionView& view, std::size_t eye, bool capture,
               NullFrame& frame) {
  frame.stage_from_eye[eye] = from_xr(view.pose);
  frame.fov[eye] = {view.fov.angleLeft, view.fov.angleRight, view.fov.angleUp, view.fov.angleDown};
  frame.width_px = view.subImage.imageRect.extent.width;
  frame.height_px = view.subImage.imageRect.extent.height;
  const auto* depth = static_cast<const XrCompositionLayerDepthInfoKHR*>(view.next);
  frame.has_depth = depth != nullptr && depth->type == XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR;
  if (frame.has_depth) {
    frame.min_depth = depth->minDepth, frame.max_depth = depth->maxDepth;
    frame.near_z = depth->nearZ, frame.far_z = depth->farZ;
  }
  if (!capture) return;
  read_texture(view.subImage, frame.rgba[eye]);
  if (frame.has_depth) read_depth(depth->subImage, frame.depth[eye]);
}

XrResult XRAPI_CALL end_frame(XrSession, const XrFrameEndInfo* info) {
  if (is_lost()) return XR_ERROR_SESSION_LOST;
  if (!state.in_frame) return misuse("xrEndFrame without xrBeginFrame");
  state.in_frame = false;
  const auto every = runtime.script.capture_every;
  NullFrame frame;
  frame.index = state.frame;
  frame.predicted_display_ns = info->displayTime - kTimeOffset_ns;
  for (std::uint32_t i = 0; i < info->layerCount; ++i) {
    if (info->layers[i]->type != XR_TYPE_COMPOSITION_LAYER_PROJECTION) continue;
    const auto& layer = *reinterpret_cast<const XrCompositionLayerProjection*>(info->layers[i]);
    frame.has_layer = true;
    for (std::size_t eye = 0; eye < layer.viewCount; ++eye)
      note_view(layer.views[eye], eye, every > 0 && state.frame % every == 0, frame);
  }
  const auto held = lock();
  runtime.frames.push_back(std::move(frame));
  return XR_SUCCESS;
}

/// Debian 12's loader calls a missing core function as a null pointer.
XrResult XRAPI_CALL unsupported() {
  return XR_ERROR_FUNCTION_UNSUPPORTED;
}

XrResult XRAPI_CALL get_instance_proc_addr(XrInstance, const char* name,
                                           PFN_xrVoidFunction* function);

template <class Function>
PFN_xrVoidFunction entry(Function function) {
  return reinterpret_cast<PFN_xrVoidFunction>(function);
}

const std::map<std::string, PFN_xrVoidFunction>& entries() {
  static const std::map<std::string, PFN_xrVoidFunction> kEntries{
      {"xrGetInstanceProcAddr", entry(get_instance_proc_addr)},
      {"xrEnumerateInstanceExtensionProperties", entry(enumerate_extensions)},
      {"xrCreateInstance", entry(create_instance)},
      {"xrDestroyInstance", entry(destroy_instance)},
      {"xrGetInstanceProperties", entry(get_instance_properties)},
      {"xrGetSystem", entry(get_system)},
      {"xrGetSystemProperties", entry(get_system_properties)},
      {"xrEnumerateViewConfigurationViews", entry(enumerate_views)},
      {"xrGetOpenGLGraphicsRequirementsKHR", entry(get_opengl_requirements)},
      {"xrConvertTimespecTimeToTimeKHR", entry(time_from_timespec)},
      {"xrConvertTimeToTimespecTimeKHR", entry(timespec_from_time)},
      {"xrPollEvent", entry(poll_event)},
      {"xrCreateSession", entry(create_session)},
      {"xrDestroySession", entry(destroy_session)},
      {"xrBeginSession", entry(begin_session)},
      {"xrRequestExitSession", entry(request_exit)},
      {"xrEndSession", entry(end_session)},
      {"xrCreateReferenceSpace", entry(create_reference_space)},
      {"xrDestroySpace", entry(destroy_space)},
      {"xrLocateSpace", entry(locate_space)},
      {"xrStringToPath", entry(string_to_path)},
      {"xrCreateActionSet", entry(create_action_set)},
      {"xrDestroyActionSet", entry(destroy_action_set)},
      {"xrCreateAction", entry(create_action)},
      {"xrSuggestInteractionProfileBindings", entry(suggest_bindings)},
      {"xrAttachSessionActionSets", entry(attach_action_sets)},
      {"xrCreateActionSpace", entry(create_action_space)},
      {"xrSyncActions", entry(sync_actions)},
      {"xrGetActionStatePose", entry(get_action_state_pose)},
      {"xrEnumerateSwapchainFormats", entry(enumerate_formats)},
      {"xrCreateSwapchain", entry(create_swapchain)},
      {"xrDestroySwapchain", entry(destroy_swapchain)},
      {"xrEnumerateSwapchainImages", entry(enumerate_images)},
      {"xrAcquireSwapchainImage", entry(acquire_image)},
      {"xrWaitSwapchainImage", entry(wait_image)},
      {"xrReleaseSwapchainImage", entry(release_image)},
      {"xrWaitFrame", entry(wait_frame)},
      {"xrBeginFrame", entry(begin_frame)},
      {"xrLocateViews", entry(locate_views)},
      {"xrEndFrame", entry(end_frame)},
  };
  return kEntries;
}

XrResult XRAPI_CALL get_instance_proc_addr(XrInstance, const char* name,
                                           PFN_xrVoidFunction* function) {
  const auto found = entries().find(name);
  *function = found != entries().end() ? found->second : entry(unsupported);
  return XR_SUCCESS;
}

}  // namespace
}  // namespace macula::test

extern "C" {

macula::test::NullRuntime* macula_null_runtime() {
  return &macula::test::runtime;
}

XrResult XRAPI_CALL xrNegotiateLoaderRuntimeInterface(
    const macula::test::NegotiateLoaderInfo*, macula::test::NegotiateRuntimeRequest* request) {
  request->runtimeInterfaceVersion = 1;
  request->runtimeApiVersion = XR_MAKE_VERSION(1, 0, 20);
  request->getInstanceProcAddr = macula::test::get_instance_proc_addr;
  return XR_SUCCESS;
}
}
