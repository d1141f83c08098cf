#include "tests/bench/streaming_viewer.h"

#include <algorithm>
#include <thread>

#include "client/app/refresh_clock.h"

namespace macula::bench {
namespace {

constexpr double kRefreshHz = 72.0;
constexpr Nanoseconds kViewEvery = std::chrono::milliseconds{4};
constexpr Nanoseconds kWarp = std::chrono::milliseconds{5};  // left for what it does not do

/// Decodes on a thread of its own, as client_app::FrameReceiver does, and counts besides.
class Receiver {
 public:
  Receiver(net::ClientEndpoint& endpoint, const base::Clock& clock, frames::StageBook& book)
      : endpoint_(endpoint),
        book_(book),
        decoder_(clock),
        thread_([this](const std::stop_token& stop) { work(stop); }) {}

  frames::FrameStore& store() { return store_; }
  /// Ends the thread and hands over what it noted.
  void finish(Viewed& viewed) {
    thread_.request_stop();
    thread_.join();
    viewed.transit_ms = transit_ms_;
    viewed.credit_wait_ms = credit_wait_ms_;
    viewed.render_ms = render_ms_;
    viewed.decode_cpu_ms = decode_cpu_ms_;
    viewed.frame_bytes = frame_bytes_;
    viewed.cells = cells_;
    viewed.received = received_;
    viewed.undecodable = undecodable_;
  }

 private:
  void work(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      auto received = endpoint_.wait_frame(std::chrono::milliseconds{20});
      if (!received) continue;
      ++received_;
      book_.note_begin(received->begin);
      note_times(*received);
      auto frame = decoder_.decode(std::move(*received));
      if (!frame) {
        ++undecodable_;
        endpoint_.request_key();
        continue;
      }
      decode_cpu_ms_.add(units::to_ms(frame->cpu));
      frame_bytes_.add(static_cast<double>(frame->bytes));
      cells_.add(static_cast<double>(frame->end.cells));
      store_.put(std::make_shared<const frames::DecodedFrame>(std::move(*frame)));
    }
  }

  /// When a frame was handed over is told by the next one.
  void note_times(const net::ReceivedFrame& received) {
    const net::FrameBegin& begin = received.begin;
    render_ms_.add(units::to_ms(received.end.render_end - received.end.render_begin));
    if (last_ && last_->begin.epoch == begin.epoch && last_->begin.frame == begin.previous_frame) {
      const Nanoseconds handed_over = begin.previous_send_begin.time_since_epoch();
      transit_ms_.add(units::to_ms(last_->last_byte.time_since_epoch() - handed_over));
      credit_wait_ms_.add(units::to_ms(handed_over - last_->end.encode_end.time_since_epoch()));
    }
    last_.emplace();
    last_->begin.epoch = begin.epoch;
    last_->begin.frame = begin.frame;
    last_->end = received.end;
    last_->last_byte = received.last_byte;
  }

  net::ClientEndpoint& endpoint_;
  frames::StageBook& book_;
  std::optional<net::ReceivedFrame> last_;  ///< without its pictures
  frames::Series credit_wait_ms_, render_ms_;
  frames::FrameDecoder decoder_;
  frames::FrameStore store_;
  frames::Series transit_ms_, decode_cpu_ms_, frame_bytes_, cells_;
  std::uint64_t received_ = 0, undecodable_ = 0;
  std::jthread thread_;
};

net::ViewState view_of(const client_app::EyeRig& rig, const pose::HeadSample& head,
                       std::uint64_t sequence, Nanoseconds period) {
  net::ViewState view = rig.view_state(head.stage_from_head, head.gaze);
  view.sequence = sequence;
  view.sampled = head.at;
  view.gaze_sampled = head.gaze_at;
  view.predicted_display = head.at + period;
  return view;
}

/// As DisplayLoop does until its warp must begin: a frame begun meanwhile begins from a new head.
void publish_meanwhile(net::ClientEndpoint& endpoint, const base::Clock& clock,
                       const client_app::EyeRig& rig, pose::TraceSource& poses,
                       const client_app::Refresh& refresh, std::uint64_t& sequence) {
  const ClientTime end = refresh.display - kWarp;
  for (ClientTime now{clock.now()}; now < end; now = ClientTime{clock.now()}) {
    std::this_thread::sleep_for(std::min<Nanoseconds>(kViewEvery, end - now));
    auto head = poses.sample(ClientTime{clock.now()});
    if (!head) return;
    head->at = head->gaze_at = ClientTime{clock.now()};
    endpoint.publish(view_of(rig, *head, ++sequence, refresh.display - head->at));
  }
}

void note_clock(const net::ClientEndpoint& endpoint, Viewed& viewed) {
  const auto estimate = endpoint.clock();
  if (!estimate) return;
  const Nanoseconds error = std::chrono::abs(estimate->server_minus_client);
  viewed.clock_error_ms.add(units::to_ms(error));
  viewed.clock_bound_broken += error > estimate->bound ? 1 : 0;
}

void note_first_showing(const frames::FramePtr& frame, ClientTime begin, ClientTime shown,
                        const net::ClientEndpoint& endpoint, frames::StageBook& book,
                        Viewed& viewed) {
  ++viewed.shown;
  viewed.news.push_back(shown);
  if (viewed.shown % 72 == 30) viewed.samples.push_back(frame);
  if (const auto clock = endpoint.clock()) {
    book.note_shown(
        frame->id(), frame->end,
        {frame->begin.view_sampled, frame->last_byte, frame->decoded, begin, begin, shown}, *clock);
  }
}

}  // namespace

Viewed view_stream(net::ClientEndpoint& endpoint, const base::Clock& clock,
                   const client_app::EyeRig& rig, pose::TraceSource& poses, double seconds,
                   const std::function<void(double share)>& at_refresh) {
  Viewed viewed;
  frames::StageBook book;
  Receiver receiver(endpoint, clock, book);
  client_app::RefreshClock refreshes(clock, kRefreshHz, client_app::Pacing::RealTime);
  const ClientTime opened{clock.now()};
  std::optional<ClientTime> first_frame;
  frames::FramePtr last;
  for (std::uint64_t sequence = 1;; ++sequence) {
    const client_app::Refresh refresh = refreshes.next();
    auto head = poses.sample(refresh.pose_time);
    if (!head) break;
    head->at = head->gaze_at = refresh.begin;
    endpoint.publish(view_of(rig, *head, sequence, refresh.display - refresh.begin));
    while (endpoint.take_event()) {
    }
    publish_meanwhile(endpoint, clock, rig, poses, refresh, sequence);
    const ClientTime begin{clock.now()};
    const frames::FramePtr frame = receiver.store().newest();
    refreshes.wait_for_display(refresh);
    const ClientTime shown{clock.now()};
    if (!frame) {
      if (shown - opened > std::chrono::seconds{30}) break;
      continue;
    }
    if (!first_frame) first_frame = shown;
    const double passed_s = units::to_s(shown - *first_frame);
    if (passed_s > seconds) break;
    at_refresh(passed_s / seconds);
    ++viewed.refreshes;
    viewed.ages.add(shown, frame->begin);
    viewed.refresh_at.push_back(shown);
    viewed.age_ms_by_refresh.push_back(units::to_ms(shown - frame->begin.view_sampled));
    note_clock(endpoint, viewed);
    if (frame != last) note_first_showing(frame, begin, shown, endpoint, book, viewed);
    last = frame;
    viewed.duration_s = passed_s;
  }
  receiver.finish(viewed);
  viewed.accounts = book.accounts();
  return viewed;
}

}  // namespace macula::bench
