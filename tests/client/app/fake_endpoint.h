// An endpoint without a network: answers every view with a frame made of known pixels, at once,
// with the stamps of a server whose clock is far off.
#pragma once

#include <mutex>

#include "shared/base/clock.h"
#include "shared/base/mailbox.h"
#include "shared/net/client_endpoint.h"
#include "tests/client/frames/encoded_frames.h"

namespace macula::test {

class FakeEndpoint final : public net::ClientEndpoint {
 public:
  enum class Manner { AnswersEveryView, NeverWelcomes, Refuses, FallsSilentAfterFive };

  explicit FakeEndpoint(const base::Clock& clock, Manner manner = Manner::AnswersEveryView)
      : clock_(clock), manner_(manner) {}

  void publish(net::ViewState view) override {
    std::lock_guard lock(mutex_);
    views_.push_back(view);
    if (manner_ == Manner::FallsSilentAfterFive && frames_ >= 5) return;
    mailbox_.put(answer(view));
  }
  void send(net::Message message) override {
    std::lock_guard lock(mutex_);
    said_bye_ = said_bye_ || std::holds_alternative<net::Bye>(message);
  }
  std::optional<net::ReceivedFrame> wait_frame(Nanoseconds timeout) override {
    return mailbox_.wait(timeout);
  }
  void request_key() override {}
  std::optional<net::ClientEvent> take_event() override {
    std::lock_guard lock(mutex_);
    if (std::exchange(spoken_, true) || manner_ == Manner::NeverWelcomes) return std::nullopt;
    if (manner_ == Manner::Refuses) {
      return net::Refused{{net::RefusalCode::VersionMismatch, "update the client to version 2"}};
    }
    net::Welcomed welcomed;
    welcomed.welcome.scene.name = "known pixels";
    return welcomed;
  }
  std::optional<net::ClockEstimate> clock() const override {
    return net::ClockEstimate{kOffset, units::from_ms(0.1), units::from_ms(0.2)};
  }
  net::ClientCounters counters() const override { return {}; }

  std::vector<net::ViewState> views() const {
    std::lock_guard lock(mutex_);
    return views_;
  }
  bool said_bye() const {
    std::lock_guard lock(mutex_);
    return said_bye_;
  }

 private:
  static constexpr Nanoseconds kOffset{123'456'789'012};

  ServerTime server_now() const { return ServerTime{clock_.now() + kOffset}; }

  net::ReceivedFrame answer(const net::ViewState& view) {
    net::ReceivedFrame frame =
        make_received_frame(7, ++frames_, static_cast<std::uint32_t>(view.eyes.size()));
    net::FrameBegin& begin = frame.begin;
    begin.view_sequence = view.sequence;
    begin.view_sampled = view.sampled;
    begin.view_predicted_display = view.predicted_display;
    begin.gaze_sampled = view.gaze_sampled;
    for (std::size_t eye = 0; eye < view.eyes.size(); ++eye) {
      begin.views[eye].stage_from_view = view.stage_from_head * view.eyes[eye].head_from_eye;
      begin.views[eye].gaze = view.eyes[eye].gaze;
    }
    begin.previous_frame = frames_ - 1;
    begin.previous_send_begin = begin.previous_send_end = last_sent_;
    const ServerTime now = server_now();
    frame.end.view_received = frame.end.render_begin = frame.end.render_end = now;
    frame.end.encode_begin = frame.end.encode_end = last_sent_ = now;
    frame.first_byte = frame.last_byte = ClientTime{clock_.now()};
    return frame;
  }

  const base::Clock& clock_;
  const Manner manner_;
  mutable std::mutex mutex_;
  base::Mailbox<net::ReceivedFrame> mailbox_;
  std::vector<net::ViewState> views_;
  std::uint64_t frames_ = 0;
  ServerTime last_sent_{};
  bool spoken_ = false, said_bye_ = false;
};

}  // namespace macula::test
