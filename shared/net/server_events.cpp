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
  {
    std::lock_guard lock(mutex_);
    const bool every_one_counts = std::holds_alternative<FrameSent>(event);
    const auto waiting = std::find_if(events_.begin(), events_.end(), [&](const ServerEvent& e) {
      return e.index() == event.index() && peer_of(e) == peer_of(event);
    });
    if (every_one_counts || waiting == events_.end()) {
      events_.push_back(std::move(event));
    } else {
      replace(*waiting, std::move(event));
    }
  }
  arrived_.notify_one();
}

std::optional<ServerEvent> ServerEvents::wait(Nanoseconds timeout) {
  std::unique_lock lock(mutex_);
  arrived_.wait_for(lock, timeout, [this] { return !events_.empty() || closed_; });
  if (events_.empty()) return std::nullopt;
  std::optional<ServerEvent> event(std::move(events_.front()));
  events_.pop_front();
  return event;
}

void ServerEvents::close() {
  {
    std::lock_guard lock(mutex_);
    closed_ = true;
  }
  arrived_.notify_all();
}

}  // namespace macula::net
