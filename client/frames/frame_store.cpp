#include "client/frames/frame_store.h"

#include <utility>

#include "shared/base/check.h"

namespace macula::frames {

FrameStore::Admission FrameStore::put(FramePtr frame) {
  MACULA_CHECK(frame != nullptr, "no frame to keep");
  {
    std::lock_guard lock(mutex_);
    if (!order_.advance(frame->id())) return Admission::Refused;
    previous_ = std::exchange(newest_, std::move(frame));
  }
  arrived_.notify_all();
  return Admission::Newest;
}

FramePtr FrameStore::newest() const {
  std::lock_guard lock(mutex_);
  return newest_;
}

FramePtr FrameStore::previous() const {
  std::lock_guard lock(mutex_);
  return previous_;
}

FramePtr FrameStore::wait_newer(std::optional<FrameId> seen, Nanoseconds timeout) const {
  std::unique_lock lock(mutex_);
  const auto is_news = [&] { return newest_ && newest_->id() != seen; };
  arrived_.wait_for(lock, timeout, [&] { return closed_ || is_news(); });
  return is_news() ? newest_ : nullptr;
}

void FrameStore::close() {
  {
    std::lock_guard lock(mutex_);
    closed_ = true;
  }
  arrived_.notify_all();
}

}  // namespace macula::frames
