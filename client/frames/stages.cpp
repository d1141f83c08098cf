#include "client/frames/stages.h"

#include <algorithm>
#include <numeric>

namespace macula::frames {
namespace {

struct Span {
  Stage stage;
  ClientTime begin, end;
};

/// The path in the order data takes it; PresentWait comes twice.
std::array<Span, kStageCount + 1> path(const ServerStamps& s, const ClientStamps& c,
                                       const net::ClockEstimate& clock) {
  const auto here = [&clock](ServerTime t) { return clock.to_client(t); };
  return {{
      {Stage::Uplink, c.view_sampled, here(s.view_received)},
      {Stage::ViewWait, here(s.view_received), here(s.render_begin)},
      {Stage::Render, here(s.render_begin), here(s.render_end)},
      {Stage::Encode, here(s.encode_begin), here(s.encode_end)},
      {Stage::SendQueue, here(s.encode_end), here(s.send_end)},
      {Stage::Downlink, here(s.send_end), c.last_byte},
      {Stage::Decode, c.last_byte, c.decoded},
      {Stage::PresentWait, c.decoded, c.reproject_begin},
      {Stage::Reproject, c.reproject_begin, c.reproject_end},
      {Stage::PresentWait, c.reproject_end, c.shown},
  }};
}

}  // namespace

const char* name(Stage stage) {
  switch (stage) {
    case Stage::Uplink:
      return "uplink";
    case Stage::ViewWait:
      return "view_wait";
    case Stage::Render:
      return "render";
    case Stage::Encode:
      return "encode";
    case Stage::SendQueue:
      return "send_queue";
    case Stage::Downlink:
      return "downlink";
    case Stage::Decode:
      return "decode";
    case Stage::Reproject:
      return "reproject";
    case Stage::PresentWait:
      return "present_wait";
  }
  return "?";
}

Nanoseconds StageTimes::sum() const {
  return std::accumulate(stages.begin(), stages.end(), Nanoseconds{0});
}

StageTimes account(const ServerStamps& server, const ClientStamps& client,
                   const net::ClockEstimate& clock) {
  StageTimes times;
  times.total = client.shown - client.view_sampled;
  ClientTime covered = client.view_sampled;
  for (const Span& span : path(server, client, clock)) {
    times.unattributed += std::max(span.begin - covered, Nanoseconds{0});
    times.stages[static_cast<std::size_t>(span.stage)] += span.end - std::max(span.begin, covered);
    covered = span.end;
  }
  return times;
}

}  // namespace macula::frames
