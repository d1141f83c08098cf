#include "client/display/openxr/session.h"

#include <array>
#include <vector>

#include "client/display/openxr/xr_values.h"

namespace macula::display {
namespace {

constexpr XrViewConfigurationType kStereo = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;

/// What current GLX state says of itself.
Result<XrGraphicsBindingOpenGLXlibKHR> current_binding() {
  Display* const display = glXGetCurrentDisplay();
  const GLXContext context = glXGetCurrentContext();
  if (display == nullptr || context == nullptr)
    return base::runtime_error("no GLX context is current", "OpenXR",
                               "an X server is needed (DISPLAY); Wayland's Xwayland serves too");
  int config_id = 0, visual = 0, count = 0;
  glXQueryContext(display, context, GLX_FBCONFIG_ID, &config_id);
  const std::array<int, 3> wanted{GLX_FBCONFIG_ID, config_id, 0};
  GLXFBConfig* const configs =
      glXChooseFBConfig(display, DefaultScreen(display), wanted.data(), &count);
  if (configs == nullptr || count == 0)
    return base::runtime_error("the GLX context has no configuration", "OpenXR");
  auto binding =
      xr_struct<XrGraphicsBindingOpenGLXlibKHR>(XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR);
  binding.xDisplay = display;
  binding.glxFBConfig = configs[0];
  glXGetFBConfigAttrib(display, configs[0], GLX_VISUAL_ID, &visual);
  binding.visualid = static_cast<std::uint32_t>(visual);
  binding.glxDrawable = glXGetCurrentDrawable();
  binding.glxContext = context;
  XFree(configs);
  return binding;
}

/// The specification wants this asked before a session, whatever the answer.
Result<void> ask_graphics_requirements(const Runtime& runtime) {
  const auto ask = runtime.function<PFN_xrGetOpenGLGraphicsRequirementsKHR>(
      "xrGetOpenGLGraphicsRequirementsKHR");
  if (ask == nullptr) return base::runtime_error("the runtime knows no OpenGL", "OpenXR");
  auto requirements =
      xr_struct<XrGraphicsRequirementsOpenGLKHR>(XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR);
  return check_xr(ask(runtime.instance(), runtime.system(), &requirements),
                  "the runtime's needs of OpenGL cannot be read");
}

constexpr XrSpaceLocationFlags kPoseValid =
    XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT;

}  // namespace

Result<std::unique_ptr<Session>> Session::create(const Runtime& runtime) {
  auto session = std::unique_ptr<Session>(new Session(runtime));
  if (auto done = session->open(); !done) return base::forward(done);
  if (auto done = session->make_spaces(); !done) return base::forward(done);
  return session;
}

Session::~Session() {
  for (const XrSpace space : {head_, stage_}) {
    if (space != XR_NULL_HANDLE) xrDestroySpace(space);
  }
  if (session_ != XR_NULL_HANDLE) xrDestroySession(session_);
}

Result<void> Session::open() {
  if (auto done = ask_graphics_requirements(runtime_); !done) return done;
  const auto binding = current_binding();
  if (!binding) return base::forward(binding);
  auto info = xr_struct<XrSessionCreateInfo>(XR_TYPE_SESSION_CREATE_INFO);
  info.next = &*binding;
  info.systemId = runtime_.system();
  return check_xr(xrCreateSession(runtime_.instance(), &info, &session_),
                  "the runtime begins no session");
}

Result<void> Session::make_spaces() {
  constexpr float kStanding_m = 1.6F;  // eyes above the floor, where only the eyes are known
  XrReferenceSpaceCreateInfo info{XR_TYPE_REFERENCE_SPACE_CREATE_INFO, nullptr,
                                  XR_REFERENCE_SPACE_TYPE_STAGE, identity_pose()};
  if (XR_FAILED(xrCreateReferenceSpace(session_, &info, &stage_))) {
    info.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_LOCAL;
    info.poseInReferenceSpace.position.y = -kStanding_m;
    if (auto done = check_xr(xrCreateReferenceSpace(session_, &info, &stage_), "no stage"); !done)
      return done;
  }
  info.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_VIEW;
  info.poseInReferenceSpace = identity_pose();
  return check_xr(xrCreateReferenceSpace(session_, &info, &head_), "the head has no space");
}

bool Session::succeeded(XrResult result) {
  if (is_lost(result)) state_ = HeadsetState::Lost;
  return XR_SUCCEEDED(result);
}

HeadsetState Session::poll() {
  while (state_ != HeadsetState::Lost) {
    auto event = xr_struct<XrEventDataBuffer>(XR_TYPE_EVENT_DATA_BUFFER);
    const XrResult polled = xrPollEvent(runtime_.instance(), &event);
    if (!succeeded(polled) || polled == XR_EVENT_UNAVAILABLE) break;
    take(event);
  }
  return state_;
}

void Session::take(const XrEventDataBuffer& event) {
  if (event.type == XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING) state_ = HeadsetState::Lost;
  if (event.type != XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED) return;
  const auto& changed = reinterpret_cast<const XrEventDataSessionStateChanged&>(event);
  if (changed.session == session_) enter(changed.state);
}

void Session::enter(XrSessionState state) {
  switch (state) {
    case XR_SESSION_STATE_READY: {
      const XrSessionBeginInfo begin{XR_TYPE_SESSION_BEGIN_INFO, nullptr, kStereo};
      if (succeeded(xrBeginSession(session_, &begin))) state_ = HeadsetState::Running;
      return;
    }
    case XR_SESSION_STATE_STOPPING:
      if (succeeded(xrEndSession(session_))) state_ = HeadsetState::Idle;
      return;
    case XR_SESSION_STATE_EXITING:
      state_ = HeadsetState::Closed;
      return;
    case XR_SESSION_STATE_LOSS_PENDING:
      state_ = HeadsetState::Lost;
      return;
    default:
      return;  // synchronized, visible, focused: frames go on as they are
  }
}

std::optional<HeadsetFrame> Session::begin_frame() {
  auto frame = xr_struct<XrFrameState>(XR_TYPE_FRAME_STATE);
  if (!succeeded(xrWaitFrame(session_, nullptr, &frame))) return std::nullopt;
  if (!succeeded(xrBeginFrame(session_, nullptr))) return std::nullopt;
  display_ = frame.predictedDisplayTime;
  return HeadsetFrame{runtime_.from_xr(frame.predictedDisplayTime),
                      Nanoseconds{frame.predictedDisplayPeriod}, frame.shouldRender == XR_TRUE};
}

void Session::end_frame(std::span<const XrCompositionLayerBaseHeader* const> layers) {
  const XrFrameEndInfo end{XR_TYPE_FRAME_END_INFO,
                           nullptr,
                           display_,
                           XR_ENVIRONMENT_BLEND_MODE_OPAQUE,
                           static_cast<std::uint32_t>(layers.size()),
                           layers.data()};
  succeeded(xrEndFrame(session_, &end));
}

std::optional<Pose> Session::stage_from_head(ClientTime at) {
  XrSpaceLocation location{XR_TYPE_SPACE_LOCATION, nullptr, 0, identity_pose()};
  if (!succeeded(xrLocateSpace(head_, stage_, runtime_.to_xr(at), &location))) return std::nullopt;
  if ((location.locationFlags & kPoseValid) != kPoseValid) return std::nullopt;
  return from_xr(location.pose);
}

std::optional<HeadsetEyes> Session::eyes(ClientTime at) {
  const XrViewLocateInfo info{XR_TYPE_VIEW_LOCATE_INFO, nullptr, kStereo, runtime_.to_xr(at),
                              stage_};
  auto flags = xr_struct<XrViewState>(XR_TYPE_VIEW_STATE);
  std::array<XrView, 2> views;
  views.fill({XR_TYPE_VIEW, nullptr, identity_pose(), {}});
  std::uint32_t count = 0;
  if (!succeeded(xrLocateViews(session_, &info, &flags, static_cast<std::uint32_t>(views.size()),
                               &count, views.data())))
    return std::nullopt;
  // Tracked or not is the runtime's affair: a pose it calls valid is the best there is.
  constexpr XrViewStateFlags kValid =
      XR_VIEW_STATE_ORIENTATION_VALID_BIT | XR_VIEW_STATE_POSITION_VALID_BIT;
  if (count != views.size() || (flags.viewStateFlags & kValid) != kValid) return std::nullopt;
  HeadsetEyes eyes;
  for (std::size_t i = 0; i < views.size(); ++i)
    eyes[i] = {from_xr(views[i].pose), from_xr(views[i].fov)};
  return eyes;
}

void Session::request_exit() {
  if (!succeeded(xrRequestExitSession(session_)) && state_ != HeadsetState::Lost)
    state_ = HeadsetState::Closed;  // it was not running: nothing to stop
}

}  // namespace macula::display
