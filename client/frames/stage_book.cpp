#include "client/frames/stage_book.h"

#include <algorithm>

namespace macula::frames {
namespace {

/// A frame is shown before this many later ones have come, or never.
constexpr std::size_t kMostSent = 64;

ServerStamps server_stamps(const net::FrameEnd& end) {
  ServerStamps stamps;
  stamps.view_received = end.view_received;
  stamps.render_begin = end.render_begin;
  stamps.render_end = end.render_end;
  stamps.encode_begin = end.encode_begin;
  stamps.encode_end = end.encode_end;
  return stamps;
}

}  // namespace

void StageBook::note_begin(const net::FrameBegin& begin) {
  if (begin.previous_frame == 0) return;
  const FrameId id{begin.epoch, begin.previous_frame};
  std::lock_guard lock(mutex_);
  sent_.push_back({id, begin.previous_send_end});
  if (sent_.size() > kMostSent) sent_.pop_front();
  join(id);
}

void StageBook::note_shown(FrameId id, const net::FrameEnd& end, const ClientStamps& stamps,
                           const net::ClockEstimate& clock) {
  std::lock_guard lock(mutex_);
  shown_.insert_or_assign(id, Shown{server_stamps(end), stamps, clock});
  join(id);
  if (shown_.size() <= kMostSent) return;
  shown_.erase(shown_.begin());
  ++given_up_;
}

void StageBook::join(FrameId id) {
  const auto shown = shown_.find(id);
  const auto sent =
      std::find_if(sent_.begin(), sent_.end(), [id](const Sent& s) { return s.id == id; });
  if (shown == shown_.end() || sent == sent_.end()) return;
  ServerStamps server = shown->second.server;
  server.send_end = sent->end;
  accounts_.push_back({id, account(server, shown->second.client, shown->second.clock)});
  if (accounts_.size() > kMostAccounts) {
    accounts_.pop_front();
    ++left_out_;
  }
  shown_.erase(shown);
  sent_.erase(sent);
}

std::vector<AccountedFrame> StageBook::accounts_after(std::size_t count) const {
  std::lock_guard lock(mutex_);
  const std::size_t skipped = count > left_out_ ? count - left_out_ : 0;
  const auto first = static_cast<std::ptrdiff_t>(std::min(skipped, accounts_.size()));
  return {accounts_.begin() + first, accounts_.end()};
}

std::uint64_t StageBook::accounted() const {
  std::lock_guard lock(mutex_);
  return left_out_ + accounts_.size();
}

std::uint64_t StageBook::incomplete() const {
  std::lock_guard lock(mutex_);
  return given_up_ + shown_.size();
}

}  // namespace macula::frames
