// FrameReceiver: the thread between the network and the display loop. It takes complete frames as
// they come, decodes them, and puts them where the loop finds the newest. A frame that cannot be
// decoded is counted and told once, never shown.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "client/frames/frame_store.h"
#include "client/frames/stage_book.h"
#include "shared/base/clock.h"
#include "shared/net/client_endpoint.h"

namespace macula::client_app {

class FrameReceiver {
 public:
  /// Everything handed in must outlive it.
  FrameReceiver(net::ClientEndpoint& endpoint, const base::Clock& clock, frames::FrameStore& store,
                frames::StageBook& book, const frames::DecodeOptions& options);
  ~FrameReceiver();
  FrameReceiver(const FrameReceiver&) = delete;
  FrameReceiver& operator=(const FrameReceiver&) = delete;

  std::uint64_t undecodable() const { return undecodable_; }

 private:
  void work(const std::stop_token& stop);

  net::ClientEndpoint& endpoint_;
  const base::Clock& clock_;
  frames::FrameStore& store_;
  frames::StageBook& book_;
  const frames::DecodeOptions options_;
  std::atomic<std::uint64_t> undecodable_{0};
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace macula::client_app
