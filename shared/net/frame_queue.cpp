#include "shared/net/frame_queue.h"

#include <utility>

namespace macula::net {

FrameQueue::Put FrameQueue::put(ReceivedFrame frame) {
  return queue_.change([&](std::deque<ReceivedFrame>& waiting, bool) {
    if (frame.begin.is_key) waiting.clear();
    if (waiting.size() >= kMost) {
      waiting.clear();
      return Put::Overflowed;
    }
    waiting.push_back(std::move(frame));
    return Put::Kept;
  });
}

}  // namespace macula::net
