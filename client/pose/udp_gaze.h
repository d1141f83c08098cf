// UdpGaze: a gaze that another program sends, such as a desktop eye tracker's driver: one UDP
// packet a sample, one JSON object a packet (further members are passed over):
//   {"direction": [0.1, 0.0, -0.99], "age_ms": 4.0, "confidence": 0.9, "valid": true}
//   {"picture": [0.5, 0.5], "age_ms": 4.0}
// `direction` is in the head frame (x right, y up, looking along -z) and need not be of length 1;
// `picture` is a place in one eye's picture, (0, 0) its upper left corner, (1, 1) its lower right.
// `age_ms` (default 0, up to 1000) is how long ago the eye was measured when the packet left.
// `valid` false is a blink or a lost eye.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "client/pose/gaze_source.h"
#include "shared/base/clock.h"
#include "shared/base/result.h"
#include "shared/math/fov.h"

namespace macula::pose {

struct GazePacket {
  Gaze gaze;
  Nanoseconds age{0};
};
/// Errors say what the packet lacks. `fov`: what a picture shows.
Result<GazePacket> parse_gaze_packet(std::string_view json, const Fov& fov);

class UdpGaze final : public GazeSource {
 public:
  /// `address` is HOST:PORT, the host a numeric IPv4 address of this machine; port 0 takes a free
  /// one.
  static Result<std::unique_ptr<UdpGaze>> create(const std::string& address, const Fov& fov,
                                                 const base::Clock& clock);
  ~UdpGaze() override;
  UdpGaze(const UdpGaze&) = delete;
  UdpGaze& operator=(const UdpGaze&) = delete;

  /// The newest packet's gaze; not valid when it is older than 200 ms, and before the first.
  GazeSample sample(ClientTime at, const Pose& stage_from_head) override;
  int port() const;

 private:
  UdpGaze(int socket, const Fov& fov, const base::Clock& clock);
  void take_packets();

  const int socket_;
  const Fov fov_;
  const base::Clock& clock_;
  GazeSample newest_;
  bool complained_ = false;  ///< of a packet that cannot be read; once
};

}  // namespace macula::pose
