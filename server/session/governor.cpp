#include "server/session/governor.h"

#include <algorithm>
#include <cmath>

namespace macula::session {
namespace {

/// More than so many losses within the span: colour becomes stateless for a while.
constexpr int kTooManyKeys = 3;
constexpr Nanoseconds kKeySpan = std::chrono::seconds{2}, kStatelessFor = std::chrono::seconds{10};

/// A frame is judged so often; that costs about one frame more.
constexpr Nanoseconds kJudgeEvery = std::chrono::seconds{5};
constexpr double kSmoothing = 0.5;  ///< of estimates

}  // namespace

Governor::Governor(const Goals& goals)
    : quality_(goals.quality),
      most_rmse_(goals.most_rmse),
      has_time_goal_(goals.frame_time.has_value()),
      time_(goals.frame_time, goals.ladder),
      bytes_(goals.age) {
  set_limits();
}

/// Without a time to hold, quality is what was asked for, or the least that is good enough.
void Governor::set_limits() {
  TimeBudget::Limits limits;
  limits.most = quality_.value_or(kBestQuality);
  if (most_rmse_) {
    limits.least = time_.ladder().quality_for_error(*most_rmse_ / rmse_over_measured_);
    limits.most = has_time_goal_ || quality_ ? std::max(limits.most, limits.least) : limits.least;
  }
  time_.set_limits(limits);
}

void Governor::on_error_estimated(double rmse) {
  if (!(rmse > 0.0 && point_.rmse > 0.0)) return;
  rmse_over_measured_ *= std::pow(rmse / point_.rmse / rmse_over_measured_, kSmoothing);
  set_limits();
}

void Governor::on_key_wanted(ServerTime now) {
  if (now - keys_since_ > kKeySpan) {
    keys_since_ = now;
    keys_lately_ = 0;
  }
  if (++keys_lately_ > kTooManyKeys) stateless_until_ = now + kStatelessFor;
}

Quality Governor::plan(const LinkState& link, ServerTime now) {
  Quality quality;
  quality.bytes = bytes_.plan(link, now);
  point_ = time_.plan(now);
  quality.scale = std::min(point_.scale, quality.bytes.scale);
  quality.quality = point_.quality;
  quality.step = static_cast<std::uint32_t>(point_.step);
  quality.rmse = point_.rmse;
  if (point_.rmse_per_difference > 0.0 && (!judged_ || now - *judged_ >= kJudgeEvery)) {
    quality.rmse_per_difference = point_.rmse_per_difference;
    judged_ = now;
  }
  if (now < stateless_until_) quality.color = Quality::Color::Stateless;
  return quality;
}

}  // namespace macula::session
