// ClientConfig: everything a run of the client needs, with the defaults of the command line.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "client/app/eye_rig.h"
#include "client/reprojection/warp.h"
#include "shared/net/messages.h"
#include "shared/units/angle.h"
#include "shared/units/length.h"
#include "shared/units/time.h"

namespace macula::client_app {

enum class DisplayKind { Headless, Window, OpenXr };

/// RealTime: refreshes come at the display's rate; one that is late is missed. AsFastAsPossible:
/// every refresh waits until a server frame newer than the last shown one is decoded (at most
/// `frame_patience`, then it shows the old one again), while poses advance by exactly one refresh
/// period each. Stamps and ages are those of the real clock in both.
enum class Pacing { RealTime, AsFastAsPossible };

/// Delays for tests that show where time goes; zero in production. (The uplink's is the
/// endpoint's.)
struct StageDelays {
  Nanoseconds decode{0}, reproject{0}, present{0};
  Nanoseconds idle{0};  ///< between refreshes, in no stage
};

struct ClientConfig {
  std::string connect = "tcp://127.0.0.1:7788";
  std::string key_folder;
  Nanoseconds connect_patience{units::from_s(10.0)};  ///< for the first Welcome
  Nanoseconds frame_patience{units::from_s(2.0)};     ///< AsFastAsPossible: for one frame
  /// A headless run without any new frame for this long ends; a window waits for ever.
  Nanoseconds silence_patience{units::from_s(10.0)};

  DisplayKind display = DisplayKind::Window;
  int width_px = 640, height_px = 640;  ///< one eye; 0: what the headset recommends
  // A headset knows these four itself.
  Degrees vertical_fov{80.0};
  int eyes = 2;  ///< 1 or 2
  Meters ipd{0.063};
  double refresh_hz = 72.0;

  Meters convergence{1.0};  ///< the eyes' gazes meet this far along the head's gaze
  Pacing pacing = Pacing::RealTime;
  /// How the newest frame is brought to the display. Grid: the mesh of slow machines, in blocks to
  /// half a pixel and with the cheaper filter.
  enum class Warp { Mesh, Grid, Rotation, Stale };
  Warp warp = Warp::Mesh;
  /// Where it runs. Gl: on the window's own OpenGL; without a window there is none.
  enum class WarpOn { Cpu, Gl };
  WarpOn warp_on = WarpOn::Cpu;

  /// Empty: the demo trace (headless), mouse and keys (window), the headset's own.
  std::string trace_file;
  /// Where the gaze comes from: with the head, from the mouse in the window whoever moves the head,
  /// from eyes that follow a moving point, or from another program (pose/udp_gaze.h).
  enum class GazeFrom { Head, Mouse, Target, Udp };
  GazeFrom gaze = GazeFrom::Head;
  std::string gaze_address;  ///< Udp: HOST:PORT
  enum class Repeat { No, Yes };
  Repeat repeat_trace = Repeat::No;
  std::uint64_t frames = 0;  ///< shown frames after which to stop; 0: when the poses end

  net::Settings settings;   ///< wishes to the server
  std::string record_file;  ///< head and gaze as a trace; empty: none is written
  std::string out_folder;   ///< pictures and report.json; empty: none are written
  int picture_every = 12;   ///< of the shown frames
  StageDelays delays;
};

reprojection::WarpOptions warp_options(ClientConfig::Warp warp);
/// The eyes where no headset says: of one size, each with a symmetric frustum.
EyeRig eye_rig(const ClientConfig& config);
net::Hello make_hello(const ClientConfig& config, const EyeRig& rig, double refresh_hz);
/// Option and value of everything in force, as printed at start and stored in the report.
std::vector<std::pair<std::string, std::string>> describe(const ClientConfig& config);

}  // namespace macula::client_app
