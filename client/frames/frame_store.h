// FrameStore: the newest complete decoded frame and the one before it. It never goes back (see
// FrameOrder) and survives a change of epoch: the last picture of the old one stays until a new one
// is there. Thread-safe; frames are immutable and shared.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>

#include "client/frames/decode.h"

namespace macula::frames {

using FramePtr = std::shared_ptr<const DecodedFrame>;

class FrameStore {
 public:
  enum class Admission { Newest, Refused };

  /// Refused: not newer than what is there.
  Admission put(FramePtr frame);
  FramePtr newest() const;    ///< null before the first
  FramePtr previous() const;  ///< null before the second
  /// The newest frame once it is another than `seen` (nullopt: any frame); null on time-out or
  /// close.
  FramePtr wait_newer(std::optional<FrameId> seen, Nanoseconds timeout) const;
  /// Wakes everyone who waits, for good.
  void close();

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable arrived_;
  FrameOrder order_;
  FramePtr newest_, previous_;
  bool closed_ = false;
};

}  // namespace macula::frames
