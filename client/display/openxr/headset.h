// Headset: a head-mounted display behind an OpenXR runtime. It tells when to draw, where head, eyes
// and gaze are, and takes the pictures of both eyes with their depth. Poses are in STAGE space, or
// in LOCAL space raised by 1.6 m where the runtime has no stage. Times are the client's monotonic
// clock; the runtime's own are translated. Pictures go through OpenGL textures, so the context that
// was current at create() must be current at every call. One thread.
//
// OpenXR 1.0 with XR_KHR_opengl_enable and XR_KHR_convert_timespec_time; used where offered:
// XR_KHR_composition_layer_depth, XR_EXT_eye_gaze_interaction.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "client/display/gl/picture_space.h"
#include "shared/base/result.h"
#include "shared/foveation/gaze.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"
#include "shared/math/fov.h"
#include "shared/math/pose.h"
#include "shared/units/time.h"

namespace macula::display {

struct HeadsetEye {
  Pose stage_from_eye;
  Fov fov;
};
using HeadsetEyes = std::array<HeadsetEye, 2>;  ///< left first

/// A frame the runtime asked for.
struct HeadsetFrame {
  ClientTime display;   ///< when it will light up, as the runtime predicts
  Nanoseconds period;   ///< from one frame to the next
  bool visible = true;  ///< false: nobody would see it; end it without pictures
};

struct HeadsetGaze {
  Gaze gaze;  ///< in the head frame; not valid where no tracker says anything
  ClientTime at{};
};

enum class HeadsetState {
  Idle,     ///< the runtime wants no frames now: worn by nobody, or shown something else
  Running,  ///< frames go begin, end, begin, end
  Closed,   ///< the runtime or request_exit() ended the session
  Lost,     ///< the runtime is gone; nothing can be shown any more
};

struct HeadsetOptions {
  /// Pixels of one eye; nullopt: what the runtime recommends. Larger than it allows is reduced.
  std::optional<PictureSize> eye_px;
};

/// One eye as it is shown.
struct HeadsetPicture {
  const image::Plane<Rgb8>& color;                 ///< display-encoded, of eye_px()
  const image::Plane<float>& inverse_depth_per_m;  ///< of the same size, or empty: no depth
};

class Headset {
 public:
  /// Connects to the runtime, waits (at most 10 s) until it wants frames, and begins its session.
  /// Needs a GLX context current. Errors say which part is missing and what to do.
  static Result<std::unique_ptr<Headset>> create(const HeadsetOptions& options);
  /// Ends the session politely.
  ~Headset();
  Headset(const Headset&) = delete;
  Headset& operator=(const Headset&) = delete;

  /// "Monado(XRT) by Collabora et al 25.0.0, Simulated HMD".
  const std::string& description() const;
  PictureSize eye_px() const;
  bool tracks_gaze() const;
  bool takes_depth() const;
  double refresh_hz() const;  ///< of the first frame
  /// The first frame's fields of view and eyes.
  const HeadsetEyes& first_eyes() const;

  /// Takes the runtime's news. Once before every frame, and while Idle.
  HeadsetState poll();
  /// While Running: waits for the runtime's pace and begins a frame, which must be ended before
  /// the next. nullopt: the runtime is gone, the next poll says so.
  std::optional<HeadsetFrame> begin_frame();
  /// nullopt: not known (yet).
  std::optional<Pose> stage_from_head(ClientTime at);
  std::optional<HeadsetEyes> eyes(ClientTime at);
  HeadsetGaze gaze(ClientTime at);
  /// Shows one picture an eye from where `eyes` are; no pictures: nothing is shown this time.
  void end_frame(const HeadsetEyes& eyes, std::span<const HeadsetPicture> pictures);
  /// poll() says Closed once the runtime has agreed.
  void request_exit();

 private:
  struct Parts;
  explicit Headset(std::unique_ptr<Parts> parts);

  std::unique_ptr<Parts> parts_;
};

}  // namespace macula::display
