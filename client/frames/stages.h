// Where the time of one shown frame went, from the head sample it was rendered for to the display.
// Every stamp is brought to client time by one clock estimate; stages are [begin, end] pairs that
// are laid on the critical path: where two overlap the later one counts only from the end of the
// earlier, and what none covers is `unattributed`. So the stages and `unattributed` add up to
// `total` exactly.
//
// A stage begins when its input is ready, so waiting for a worker belongs to that worker's stage.
// Only `uplink` and `downlink` join two clocks: they carry the estimate's error with opposite signs
// and may come out negative by as much as its bound.
#pragma once

#include <array>
#include <cstddef>

#include "shared/net/clock_sync.h"
#include "shared/net/messages.h"
#include "shared/units/time.h"

namespace macula::frames {

enum class Stage {
  Uplink,       ///< head sampled -> the server's net thread woke for the view
  ViewWait,     ///< -> rendering begins
  Render,       ///< on the server
  Encode,       ///< on the server
  SendQueue,    ///< encoded -> last byte handed to the socket, waiting for credit included
  Downlink,     ///< left the queue -> last byte here
  Decode,       ///< last byte -> pictures, waiting for the decoder included
  Reproject,    ///< the warp
  PresentWait,  ///< decoded -> picked by a refresh, and warped -> shown
};
inline constexpr std::size_t kStageCount = 9;

/// "uplink", "view_wait", ...
const char* name(Stage stage);

struct ServerStamps {
  ServerTime view_received, render_begin, render_end, encode_begin, encode_end, send_end;
};

struct ClientStamps {
  ClientTime view_sampled, last_byte, decoded, reproject_begin, reproject_end, shown;
};

struct StageTimes {
  std::array<Nanoseconds, kStageCount> stages{};
  Nanoseconds unattributed{0};
  Nanoseconds total{0};  ///< view_sampled -> shown

  Nanoseconds operator[](Stage stage) const { return stages[static_cast<std::size_t>(stage)]; }
  Nanoseconds sum() const;  ///< of the stages, without `unattributed`
};

StageTimes account(const ServerStamps& server, const ClientStamps& client,
                   const net::ClockEstimate& clock);

}  // namespace macula::frames
