#include "shared/net/frame_queue.h"

#include <utility>

namespace macula::net {

FrameQueue::Put FrameQueue::put(ReceivedFrame frame) {
  {
    std::lock_guard lock(mutex_);
    if (frame.begin.is_key) frames_.clear();
    if (frames_.size() >= kMost) {
      frames_.clear();
      return Put::Overflowed;
    }
    frames_.push_back(std::move(frame));
  }
  arrived_.notify_one();
  return Put::Kept;
}

std::optional<ReceivedFrame> FrameQueue::wait(Nanoseconds timeout) {
  std::unique_lock lock(mutex_);
  arrived_.wait_for(lock, timeout, [this] { return !frames_.empty() || closed_; });
  if (frames_.empty()) return std::nullopt;
  std::optional<ReceivedFrame> frame(std::move(frames_.front()));
  frames_.pop_front();
  return frame;
}

void FrameQueue::close() {
  {
    std::lock_guard lock(mutex_);
    closed_ = true;
  }
  arrived_.notify_all();
}

}  // namespace macula::net
