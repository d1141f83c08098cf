#include "client/display/openxr/eye_gaze.h"

#include <cstring>

#include "client/display/openxr/xr_values.h"
#include "shared/base/text.h"

namespace macula::display {
namespace {

constexpr const char* kDeniedRemedy = "let the runtime's settings allow eye tracking";

Result<XrPath> path(XrInstance instance, const char* text) {
  XrPath path = XR_NULL_PATH;
  const XrResult made = xrStringToPath(instance, text, &path);
  if (XR_FAILED(made)) return xr_error(made, base::concat("the path ", text));
  return path;
}

}  // namespace

Result<std::unique_ptr<EyeGaze>> EyeGaze::create(const Runtime& runtime, XrSession session) {
  auto gaze = std::unique_ptr<EyeGaze>(new EyeGaze(runtime, session));
  if (auto done = gaze->make_action(); !done) return base::forward(done);
  if (auto done = gaze->bind(); !done) return base::forward(done);
  return gaze;
}

EyeGaze::~EyeGaze() {
  if (space_ != XR_NULL_HANDLE) xrDestroySpace(space_);
  if (set_ != XR_NULL_HANDLE) xrDestroyActionSet(set_);  // and its action
}

Result<void> EyeGaze::make_action() {
  auto set = xr_struct<XrActionSetCreateInfo>(XR_TYPE_ACTION_SET_CREATE_INFO);
  std::strncpy(set.actionSetName, "looking", XR_MAX_ACTION_SET_NAME_SIZE - 1);
  std::strncpy(set.localizedActionSetName, "Looking", XR_MAX_LOCALIZED_ACTION_SET_NAME_SIZE - 1);
  if (auto done = check_xr(xrCreateActionSet(runtime_.instance(), &set, &set_), "no actions");
      !done)
    return done;
  auto action = xr_struct<XrActionCreateInfo>(XR_TYPE_ACTION_CREATE_INFO);
  action.actionType = XR_ACTION_TYPE_POSE_INPUT;
  std::strncpy(action.actionName, "gaze", XR_MAX_ACTION_NAME_SIZE - 1);
  std::strncpy(action.localizedActionName, "Gaze", XR_MAX_LOCALIZED_ACTION_NAME_SIZE - 1);
  return check_xr(xrCreateAction(set_, &action, &action_), "no action for the gaze");
}

Result<void> EyeGaze::bind() {
  const auto profile = path(runtime_.instance(), "/interaction_profiles/ext/eye_gaze_interaction");
  if (!profile) return base::forward(profile);
  const auto source = path(runtime_.instance(), "/user/eyes_ext/input/gaze_ext/pose");
  if (!source) return base::forward(source);
  const XrActionSuggestedBinding binding{action_, *source};
  const XrInteractionProfileSuggestedBinding suggested{
      XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING, nullptr, *profile, 1, &binding};
  if (auto done = check_xr(xrSuggestInteractionProfileBindings(runtime_.instance(), &suggested),
                           "the eye tracker is not to be had", kDeniedRemedy);
      !done)
    return done;
  const XrSessionActionSetsAttachInfo attach{XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO, nullptr, 1,
                                             &set_};
  if (auto done = check_xr(xrAttachSessionActionSets(session_, &attach),
                           "the eye tracker's action is refused");
      !done)
    return done;
  const XrActionSpaceCreateInfo space{XR_TYPE_ACTION_SPACE_CREATE_INFO, nullptr, action_,
                                      XR_NULL_PATH, identity_pose()};
  return check_xr(xrCreateActionSpace(session_, &space, &space_), "the gaze has no space");
}

bool EyeGaze::is_active() {
  const XrActiveActionSet active{set_, XR_NULL_PATH};
  const XrActionsSyncInfo sync{XR_TYPE_ACTIONS_SYNC_INFO, nullptr, 1, &active};
  if (xrSyncActions(session_, &sync) != XR_SUCCESS) return false;  // also: not focused
  const XrActionStateGetInfo get{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, action_, XR_NULL_PATH};
  auto state = xr_struct<XrActionStatePose>(XR_TYPE_ACTION_STATE_POSE);
  return XR_SUCCEEDED(xrGetActionStatePose(session_, &get, &state)) && state.isActive == XR_TRUE;
}

std::optional<EyeGaze::Sample> EyeGaze::sample(XrSpace head, ClientTime at) {
  if (!is_active()) return std::nullopt;
  XrEyeGazeSampleTimeEXT taken{XR_TYPE_EYE_GAZE_SAMPLE_TIME_EXT, nullptr, 0};
  XrSpaceLocation location{XR_TYPE_SPACE_LOCATION, &taken, 0, identity_pose()};
  if (XR_FAILED(xrLocateSpace(space_, head, runtime_.to_xr(at), &location))) return std::nullopt;
  if ((location.locationFlags & XR_SPACE_LOCATION_ORIENTATION_VALID_BIT) == 0) return std::nullopt;
  const Pose head_from_gaze = from_xr(location.pose);
  const DVec3 direction = head_from_gaze.transform_direction({0.0, 0.0, -1.0});
  return Sample{Vec3(direction), taken.time > 0 ? runtime_.from_xr(taken.time) : at};
}

}  // namespace macula::display
