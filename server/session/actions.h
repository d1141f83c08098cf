// What the session state machines ask of the world. They are values: the server carries them out, a
// simulation looks at them.
#pragma once

#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "server/scene/motion.h"
#include "server/session/governor.h"
#include "shared/foveation/gaze_follower.h"
#include "shared/net/messages.h"
#include "shared/net/server_endpoint.h"

namespace macula::session {

/// One frame of one epoch of one session.
struct FrameKey {
  std::uint64_t session = 0;
  std::uint32_t epoch = 0;
  std::uint64_t frame = 0;
  friend auto operator<=>(const FrameKey&, const FrameKey&) = default;
};

/// What the client announced and has set since; shared by the frames made under it.
struct ClientSetup {
  std::vector<foveation::Display> eyes;  ///< as Hello says; each view brings its current fov
  double refresh_hz = 72.0;
  net::Settings settings;
  bool takes_hidden_layer = false;  ///< it can draw layer 1
};

/// Render a frame from this view now; what Session::start_frame answers.
struct StartFrame {
  FrameKey key;
  net::PeerId peer;
  net::ViewState view;
  ServerTime view_received{};
  std::shared_ptr<const ClientSetup> setup;
  Nanoseconds horizon{0};    ///< how far the view's head was carried on from where it was read
  Degrees guard_band{0.0};   ///< the least to render beyond the display
  double view_cell_m = 0.0;  ///< how far eyes may move before it is seen; 0: no second layer
  std::vector<FollowedGaze>
      gazes{};  ///< by eye, for when the frame is seen; empty: as the view says
  Quality quality{};
  bool is_key_wanted = false;                    ///< colour must lean on no other frame
  std::optional<scene::SceneTime> scene_time{};  ///< nullopt: of the moment when rendering begins
};
struct SendWelcome {
  net::PeerId peer;
  net::Welcome welcome;
};
struct SendRefusal {
  net::PeerId peer;
  net::Refusal refusal;
};
struct SendBye {
  net::PeerId peer;
  net::Bye bye;
};
/// Hand a ready frame to the network.
struct ReleaseFrame {
  FrameKey key;
  net::PeerId peer;
};
/// Frames of this epoch that are not yet sent are of no more use: stop rendering, drop the ready
/// ones.
struct AbandonFrames {
  std::uint64_t session = 0;
  std::uint32_t epoch = 0;
};
struct DropSession {
  std::uint64_t session = 0;
  std::string reason;
};

/// StartFrame is not among them: frames are pulled by a free renderer, never pushed at a busy one.
using Action =
    std::variant<SendWelcome, SendRefusal, SendBye, ReleaseFrame, AbandonFrames, DropSession>;
using Actions = std::vector<Action>;

}  // namespace macula::session
