#include "server/session/governor.h"

#include <algorithm>
#include <cmath>

namespace macula::session {
namespace {

/// More than so many losses within the span: colour becomes stateless for a while.
constexpr int kTooManyKeys = 3;
constexpr Nanoseconds kKeySpan = std::chrono::seconds{2}, kStatelessFor = std::chrono::seconds{10};

/// A frame is judged at a few places so often; so many such judgements tell of all.
constexpr Nanoseconds kJudgeEvery = std::chrono::milliseconds{500};
constexpr int kRemembered = 48;
/// Estimates below this are by chance.
constexpr double kLeastSquare = 0.01;
/// By so much an estimate must move before quality does.
constexpr double kMoved = 1.1;

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
    limits.least = time_.ladder().quality_for_error(*most_rmse_ / limited_by_);
    limits.most = has_time_goal_ || quality_ ? std::max(limits.most, limits.least) : limits.least;
  }
  time_.set_limits(limits);
}

void Governor::on_error_estimated(const SpotError& error) {
  if (!(point_.rmse > 0.0 && error.weight > 0.0)) return;
  estimates_ = std::min(estimates_ + 1, kRemembered);
  const double over = error.mean_square() / (point_.rmse * point_.rmse);
  square_over_measured_ += (over - square_over_measured_) / estimates_;
  const double now = std::sqrt(std::max(square_over_measured_, kLeastSquare));
  if (estimates_ < kRemembered / 2) return;
  if (now < limited_by_ * kMoved && now * kMoved > limited_by_) return;
  limited_by_ = now;
  set_limits();
}

std::optional<double> Governor::estimated_rmse() const {
  if (estimates_ == 0) return std::nullopt;
  return point_.rmse * std::sqrt(std::max(square_over_measured_, kLeastSquare));
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
  if (point_.rmse > 0.0 && (!judged_ || now - *judged_ >= kJudgeEvery)) {
    quality.judgement = ++judgements_;
    judged_ = now;
  }
  if (now < stateless_until_) quality.color = Quality::Color::Stateless;
  return quality;
}

}  // namespace macula::session
