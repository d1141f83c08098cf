#include "shared/net/frame_sender.h"

#include <algorithm>

#include "shared/base/log.h"
#include "shared/base/text.h"
#include "shared/net/wire.h"

namespace macula::net {

void FrameSender::add(EncodedFrame frame, ServerTime handed_over, SteadyTime now) {
  newest_epoch_ = frame.begin.epoch;
  newest_frame_ = frame.begin.frame;
  Pending pending;
  pending.frame = std::move(frame);
  pending.handed_over = handed_over;
  pending.due = now + delays_.send_queue;
  pending.last_progress = pending.due;
  frames_.push_back(std::move(pending));
}

/// Waits out both injected delays; the send_queue stage ends before the second one.
bool FrameSender::is_due(Pending& pending, const Now& now, std::vector<FrameSent>& ended) {
  if (now.steady < pending.due) return false;
  if (delays_.downlink <= Nanoseconds{0} || pending.reported) return true;
  report(pending, now.server(), ended);
  pending.due = now.steady + delays_.downlink;
  pending.last_progress = pending.due;
  return false;
}

void FrameSender::progress(const Now& now, const Sink& sink, std::vector<FrameSent>& ended) {
  blocked_ = false;
  while (!frames_.empty() && is_due(frames_.front(), now, ended)) {
    Pending& pending = frames_.front();
    switch (send_next(pending, sink)) {
      case SendOutcome::Unreachable:
        lose_all(now.server(), ended);
        return;
      case SendOutcome::Full:
        blocked_ = true;
        if (now.steady - pending.last_progress > kNoProgressLimit) lose_front(now.server(), ended);
        return;
      case SendOutcome::Sent:
        pending.last_progress = now.steady;
        if (!pending.first_byte) pending.first_byte = now.steady;
        advance(pending);
    }
    if (pending.stage == Stage::Done) {
      if (!pending.reported) report(pending, now.server(), ended);
      last_sent_->first_byte = pending.first_byte;
      frames_.pop_front();
    }
  }
}

SendOutcome FrameSender::send_next(Pending& pending, const Sink& sink) {
  const SendOutcome outcome = sink(next_message(pending));
  if (outcome != SendOutcome::Full) envelope_.clear();
  return outcome;
}

bool FrameSender::has_sent_grids_of(const FrameBegin& begin) const {
  return begin.epoch == grids_epoch_ &&
         std::equal(begin.views.begin(), begin.views.end(), grids_.begin(), grids_.end(),
                    [](const FrameView& view, const PixelGrid& grid) { return view.grid == grid; });
}

std::string FrameSender::begin_envelope(const Pending& pending) const {
  FrameBegin begin = pending.frame.begin;
  if (has_sent_grids_of(begin)) {
    for (FrameView& view : begin.views) view.grid_frame = grids_frame_;
  }
  if (last_sent_ && last_sent_->epoch == begin.epoch) {
    begin.previous_frame = last_sent_->frame;
    begin.previous_send_begin = last_sent_->begin;
    begin.previous_send_end = last_sent_->end;
  }
  return encode_envelope(begin);
}

Outgoing FrameSender::next_message(Pending& pending) {
  const FrameBegin& begin = pending.frame.begin;
  if (pending.stage != Stage::Slices) {
    if (envelope_.empty()) {
      envelope_ = pending.stage == Stage::Begin ? begin_envelope(pending)
                                                : encode_envelope(pending.frame.end);
    }
    return {envelope_, nullptr, 0, 0};
  }
  if (envelope_.empty()) {
    envelope_ = encode_envelope(SliceHeader{begin.epoch, begin.frame,
                                            static_cast<std::uint32_t>(pending.slice),
                                            static_cast<std::uint32_t>(pending.offset)});
  }
  const Payload& payload = pending.frame.payloads[pending.slice];
  return {envelope_, payload, pending.offset,
          std::min(part_bytes_, payload->size() - pending.offset)};
}

/// Past the message that was just sent.
void FrameSender::advance(Pending& pending) {
  const auto& payloads = pending.frame.payloads;
  const FrameBegin& begin = pending.frame.begin;
  switch (pending.stage) {
    case Stage::Begin:
      if (!has_sent_grids_of(begin)) {
        grids_.clear();
        for (const FrameView& view : begin.views) grids_.push_back(view.grid);
        grids_epoch_ = begin.epoch;
        grids_frame_ = begin.frame;
      }
      pending.stage = payloads.empty() ? Stage::End : Stage::Slices;
      return;
    case Stage::Slices:
      pending.offset += std::min(part_bytes_, payloads[pending.slice]->size() - pending.offset);
      if (pending.offset < payloads[pending.slice]->size()) return;
      pending.offset = 0;
      if (++pending.slice == payloads.size()) pending.stage = Stage::End;
      return;
    case Stage::End:
    case Stage::Done:
      pending.stage = Stage::Done;
  }
}

void FrameSender::report(Pending& pending, ServerTime now, std::vector<FrameSent>& ended) {
  const FrameBegin& begin = pending.frame.begin;
  pending.reported = true;
  last_sent_ = Sent{begin.epoch, begin.frame, pending.handed_over, now, std::nullopt, 0};
  for (const Payload& payload : pending.frame.payloads) last_sent_->bytes += payload->size();
  ended.push_back({peer_, begin.epoch, begin.frame, pending.handed_over, now, false});
}

void FrameSender::lose_front(ServerTime now, std::vector<FrameSent>& ended) {
  const Pending& pending = frames_.front();
  const FrameBegin& begin = pending.frame.begin;
  if (!pending.reported) {
    ended.push_back({peer_, begin.epoch, begin.frame, pending.handed_over, now, true});
  }
  frames_.pop_front();
  envelope_.clear();
}

void FrameSender::lose_all(ServerTime now, std::vector<FrameSent>& ended) {
  while (!frames_.empty()) lose_front(now, ended);
  blocked_ = false;
}

void FrameSender::acknowledged(const Acks& acks, SteadyTime now) {
  if (acks.need_key) grids_.clear();  // what was lost may have brought them
  if (!last_sent_ || acks.epoch != last_sent_->epoch || acks.received != last_sent_->frame) return;
  const double bytes = static_cast<double>(std::exchange(last_sent_->bytes, 0));
  if (bytes < kSlowLinkPartBytes || !last_sent_->first_byte) return;
  const double seconds = std::chrono::duration<double>(now - *last_sent_->first_byte).count();
  const bool is_fast = bytes > kFastLink_bytes_per_s * seconds;
  // The size changes between messages only: an offered envelope names its own offset, not its size.
  part_bytes_ =
      std::min(limits_.max_part_bytes, is_fast ? limits_.max_part_bytes : kSlowLinkPartBytes);
}

std::optional<SteadyTime> FrameSender::deadline() const {
  if (frames_.empty()) return std::nullopt;
  return frames_.front().due;
}

bool FrameSender::may_acknowledge(const Acks& acks) const {
  return acks.epoch != newest_epoch_ || std::max(acks.received, acks.receiving) <= newest_frame_;
}

}  // namespace macula::net
