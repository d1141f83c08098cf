#include "shared/net/frame_assembler.h"

#include <algorithm>

#include "shared/net/wire.h"

namespace macula::net {

void FrameAssembler::start_epoch(std::uint32_t epoch) {
  arriving_.reset();
  complete_.reset();
  acks_ = {};
  acks_.epoch = epoch;
  grid_frame_ = 0;
  grids_.clear();
}

FrameAssembler::Step FrameAssembler::begin(FrameBegin begin, ClientTime now) {
  const Step before = arriving_ ? discard() : Step::Advanced;
  if (begin.epoch != acks_.epoch || begin.frame <= acks_.received) {
    return before == Step::Discarded ? before : Step::Ignored;
  }
  acks_.receiving = begin.frame;
  acks_.receiving_bytes = 0;
  if (!know_grids(begin)) return discard();
  next_slice_ = 0;
  arriving_.emplace();
  arriving_->payloads.resize(begin.slices.size());
  arriving_->begin = std::move(begin);
  arriving_->first_byte = now;
  return before;
}

bool FrameAssembler::know_grids(FrameBegin& begin) {
  const bool brings = std::all_of(begin.views.begin(), begin.views.end(),
                                  [](const FrameView& view) { return view.grid_frame == 0; });
  if (brings) {
    grids_.clear();
    for (const FrameView& view : begin.views) grids_.push_back(view.grid);
    grid_frame_ = begin.frame;
    return true;
  }
  if (grids_.size() != begin.views.size()) return false;
  for (std::size_t eye = 0; eye < grids_.size(); ++eye) {
    if (begin.views[eye].grid_frame != grid_frame_) return false;
    begin.views[eye].grid = grids_[eye];
    begin.views[eye].grid_frame = 0;
  }
  return check_frame_begin(begin, limits_).has_value();
}

bool FrameAssembler::is_beyond(std::uint32_t epoch, std::uint64_t frame) const {
  return epoch == acks_.epoch && frame > std::max(acks_.received, acks_.receiving);
}

/// The frame is given up without having begun, and so is one that was still arriving.
FrameAssembler::Step FrameAssembler::skip_to(std::uint64_t frame) {
  if (arriving_) discard();
  acks_.receiving = frame;
  return discard();
}

bool FrameAssembler::fits(const SliceHeader& header, std::size_t size) const {
  const auto& slices = arriving_->begin.slices;
  if (header.slice != next_slice_ || next_slice_ >= slices.size()) return false;
  const std::size_t came = arriving_->payloads[next_slice_].size();
  return header.offset_bytes == came && size >= 1 && size <= limits_.max_part_bytes &&
         size <= slices[next_slice_].size_bytes - came;
}

FrameAssembler::Step FrameAssembler::slice(const SliceHeader& header,
                                           std::span<const std::byte> bytes) {
  if (is_beyond(header.epoch, header.frame)) return skip_to(header.frame);
  if (!arriving_ || header.epoch != acks_.epoch || header.frame != acks_.receiving) {
    return Step::Ignored;
  }
  if (!fits(header, bytes.size())) return discard();
  std::vector<std::byte>& payload = arriving_->payloads[next_slice_];
  const std::size_t whole = arriving_->begin.slices[next_slice_].size_bytes;
  // Doubling keeps memory within twice of what came, and the last growth is exact.
  if (payload.capacity() < payload.size() + bytes.size()) {
    payload.reserve(std::min(whole, std::max(2 * payload.size(), payload.size() + bytes.size())));
  }
  payload.insert(payload.end(), bytes.data(), bytes.data() + bytes.size());
  acks_.receiving_bytes += bytes.size();
  if (payload.size() == whole) ++next_slice_;
  return Step::Advanced;
}

bool FrameAssembler::all_slices_came() const {
  return next_slice_ == arriving_->begin.slices.size();
}

FrameAssembler::Step FrameAssembler::end(const FrameEnd& end, ClientTime now) {
  if (is_beyond(end.epoch, end.frame)) return skip_to(end.frame);
  if (!arriving_ || end.epoch != acks_.epoch || end.frame != acks_.receiving) return Step::Ignored;
  if (!all_slices_came()) return discard();
  arriving_->end = end;
  arriving_->last_byte = now;
  if (arriving_->begin.is_key) acks_.need_key = false;
  complete_ = std::move(arriving_);
  arriving_.reset();
  acks_.received = end.frame;
  acks_.receiving = acks_.receiving_bytes = 0;
  return Step::Completed;
}

FrameAssembler::Step FrameAssembler::discard() {
  acks_.received = std::max(acks_.received, acks_.receiving);
  acks_.receiving = acks_.receiving_bytes = 0;
  arriving_.reset();
  want_key();
  ++incomplete_;
  return Step::Discarded;
}

std::optional<ReceivedFrame> FrameAssembler::take() {
  return std::exchange(complete_, std::nullopt);
}

}  // namespace macula::net
