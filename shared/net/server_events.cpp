#include "shared/net/server_events.h"

#include <algorithm>
#include <utility>

namespace macula::net {
namespace {

PeerId peer_of(const ServerEvent& event) {
  return std::visit([](const auto& e) { return e.peer; }, event);
}

void replace(ServerEvent& waiting, ServerEvent&& event) {
  if (auto* const view = std::get_if<ViewReceived>(&event)) {
    waiting = merge(std::get<ViewReceived>(waiting), std::move(*view));
  } else {
    waiting = std::move(event);
  }
}

}  // namespace

ViewReceived merge(const ViewReceived& older, ViewReceived newer) {
  if (!newer.view && older.view) {
    newer.view = older.view;
    newer.received = older.received;
  }
  newer.acks.need_key |= older.acks.need_key && older.acks.epoch == newer.acks.epoch;
  return newer;
}

void ServerEvents::put(ServerEvent event) {
  queue_.change([&](std::deque<ServerEvent>& events, bool) {
    const bool every_one_counts = std::holds_alternative<FrameSent>(event);
    const auto waiting = std::find_if(events.begin(), events.end(), [&](const ServerEvent& e) {
      return e.index() == event.index() && peer_of(e) == peer_of(event);
    });
    const bool is_new = every_one_counts || waiting == events.end();
    if (is_new) {
      events.push_back(std::move(event));
    } else {
      replace(*waiting, std::move(event));
    }
    return is_new;
  });
}

}  // namespace macula::net
