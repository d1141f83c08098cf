#include "client/app/frame_receiver.h"

#include <memory>
#include <utility>

#include "client/frames/decode.h"
#include "shared/base/log.h"

namespace macula::client_app {

FrameReceiver::FrameReceiver(net::ClientEndpoint& endpoint, const base::Clock& clock,
                             frames::FrameStore& store, frames::StageBook& book,
                             const frames::DecodeOptions& options)
    : endpoint_(endpoint),
      clock_(clock),
      store_(store),
      book_(book),
      options_(options),
      thread_([this](const std::stop_token& stop) { work(stop); }) {}

FrameReceiver::~FrameReceiver() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  store_.close();
}

void FrameReceiver::work(const std::stop_token& stop) {
  frames::FrameDecoder decoder(clock_, options_);
  constexpr Nanoseconds kPatience = std::chrono::milliseconds{20};
  while (!stop.stop_requested()) {
    auto received = endpoint_.wait_frame(kPatience);
    if (!received) continue;
    book_.note_begin(received->begin);
    auto frame = decoder.decode(std::move(*received));
    if (frame) {
      store_.put(std::make_shared<const frames::DecodedFrame>(std::move(*frame)));
      continue;
    }
    endpoint_.request_key();
    if (undecodable_++ == 0) {
      base::log_warning("a frame could not be decoded: " + frame.error().message());
    }
  }
}

}  // namespace macula::client_app
