// The stamps of one frame, laid end to end from chosen durations, with a server clock that is far
// off.
#pragma once

#include "client/frames/stages.h"

namespace macula::test {

struct StampedPath {
  static constexpr Nanoseconds kOffset{987'654'321'012'345};  // server minus client

  /// By frames::Stage.
  std::array<Nanoseconds, frames::kStageCount> durations{
      units::from_ms(2.0),   // uplink
      units::from_ms(1.0),   // view_wait
      units::from_ms(20.0),  // render
      units::from_ms(3.0),   // encode
      units::from_ms(0.5),   // send_queue
      units::from_ms(4.0),   // downlink
      units::from_ms(5.0),   // decode
      units::from_ms(7.0),   // reproject
      units::from_ms(6.0),   // present_wait
  };
  double before_warp_share = 0.5;    // of present_wait
  Nanoseconds gap_before_encode{0};  // negative: encode begins before render ends
  ClientTime view_sampled{units::from_s(50.0)};

  Nanoseconds of(frames::Stage stage) const { return durations[static_cast<std::size_t>(stage)]; }
  Nanoseconds total() const {
    Nanoseconds sum = gap_before_encode;
    for (const Nanoseconds duration : durations) sum += duration;
    return sum;
  }
  frames::ServerStamps server() const {
    using frames::Stage;
    frames::ServerStamps s;
    s.view_received = ServerTime{view_sampled.time_since_epoch() + kOffset} + of(Stage::Uplink);
    s.render_begin = s.view_received + of(Stage::ViewWait);
    s.render_end = s.render_begin + of(Stage::Render);
    s.encode_begin = s.render_end + gap_before_encode;
    s.encode_end = s.encode_begin + of(Stage::Encode);
    s.send_end = s.encode_end + of(Stage::SendQueue);
    return s;
  }
  frames::ClientStamps client() const {
    using frames::Stage;
    frames::ClientStamps c;
    c.view_sampled = view_sampled;
    c.last_byte = ClientTime{server().send_end.time_since_epoch() - kOffset} + of(Stage::Downlink);
    c.decoded = c.last_byte + of(Stage::Decode);
    const Nanoseconds before{static_cast<Nanoseconds::rep>(
        before_warp_share * static_cast<double>(of(Stage::PresentWait).count()))};
    c.reproject_begin = c.decoded + before;
    c.reproject_end = c.reproject_begin + of(Stage::Reproject);
    c.shown = c.reproject_end + of(Stage::PresentWait) - before;
    return c;
  }
};

}  // namespace macula::test
