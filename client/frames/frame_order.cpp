#include "client/frames/frame_order.h"

#include <algorithm>

namespace macula::frames {

bool FrameOrder::was_left(std::uint32_t epoch) const {
  return std::find(left_epochs_.begin(), left_epochs_.end(), epoch) != left_epochs_.end();
}

bool FrameOrder::advance(FrameId id) {
  if (newest_ && id.epoch == newest_->epoch) {
    if (id.frame <= newest_->frame) return false;
  } else {
    if (was_left(id.epoch)) return false;
    if (newest_) left_epochs_.push_back(newest_->epoch);
  }
  newest_ = id;
  return true;
}

}  // namespace macula::frames
