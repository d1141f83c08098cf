#include "server/session/time_budget.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace macula::session {
namespace {

// Above target x kTooSlow quality falls, below target x kTooFast it rises. A tenth of quality
// differs in cost by less than 5 % on ladders of two decades: a step taken for one reason never
// gives the other reason at once, so a steady load settles.
constexpr double kTooSlow = 1.05, kTooFast = 0.92, kAim = 0.98;
/// Beyond these something has changed: then it falls at once, and rises in strides.
constexpr double kFarTooSlow = 1.25, kFarTooFast = 0.6;
constexpr double kMostRise = 1.5;    ///< of the cost, in one change
constexpr double kPercentile = 0.9;  ///< of frame times that is held
constexpr std::size_t kRemembered = 40, kEnough = 12, kEnoughToFall = 4;
constexpr Nanoseconds kRest = std::chrono::seconds{1}, kLongestPatience = std::chrono::seconds{32};
/// Where even the quickest of the first few frames takes so much longer, no more need be seen.
constexpr double kHopeless = 3.0;
/// Where it begins: low enough for most scenes and machines to show soon how fast they are.
constexpr double kFirstQuality = 2.0;
/// A rise that has to be taken back so soon did not hold.
constexpr Nanoseconds kProof = std::chrono::seconds{4};
constexpr double kTenths = 10.0;

}  // namespace

TimeBudget::TimeBudget(std::optional<Nanoseconds> target,
                       std::shared_ptr<const QualityLadder> ladder)
    : target_(target),
      ladder_(ladder != nullptr ? std::move(ladder)
                                : std::make_shared<const QualityLadder>(QualityLadder::of_scale())),
      quality_(target ? kFirstQuality : kBestQuality),
      patience_(kRest) {}

void TimeBudget::set_limits(const Limits& limits) {
  limits_ = limits;
  const double held = std::clamp(quality_, limits.least, limits.most);
  if (held != quality_) frames_ms_.clear();
  quality_ = held;
}

void TimeBudget::on_frame(Nanoseconds render) {
  frames_ms_.push_back(units::to_ms(render));
  if (frames_ms_.size() > kRemembered) frames_ms_.pop_front();
}

std::optional<double> TimeBudget::load() const {
  if (frames_ms_.empty()) return std::nullopt;
  if (frames_ms_.size() < kEnoughToFall) {
    const double quickest = *std::ranges::min_element(frames_ms_) / units::to_ms(*target_);
    return quickest > kHopeless ? std::optional(quickest) : std::nullopt;
  }
  std::vector<double> sorted(frames_ms_.begin(), frames_ms_.end());
  std::ranges::sort(sorted);
  // One slow frame among few is no percentile: take the middle until there are enough.
  const double share = sorted.size() < kEnough ? 0.5 : kPercentile;
  const double at = share * static_cast<double>(sorted.size() - 1);
  return sorted[static_cast<std::size_t>(std::lround(at))] / units::to_ms(*target_);
}

double TimeBudget::quality_of_cost(double cost) const {
  double best = kLeastQuality;
  for (double tenth = 0.0; tenth <= kTenths * kBestQuality; tenth += 1.0)
    if (ladder_->at(tenth / kTenths).cost <= cost) best = tenth / kTenths;
  return best;
}

void TimeBudget::change_to(double quality, ServerTime now) {
  const double next = std::clamp(quality, limits_.least, limits_.most);
  if (next == quality_) return;
  quality_ = next;
  frames_ms_.clear();
  is_new_ = false;
  changed_ = now;
}

void TimeBudget::fall(double load, ServerTime now) {
  const bool is_far = load > kFarTooSlow;
  if (!is_far && changed_ && now - *changed_ < kRest) return;
  if (risen_ && now - *risen_ < kProof && !is_far)
    patience_ = std::min(2 * patience_, kLongestPatience);
  const double fits = quality_of_cost(ladder_->at(quality_).cost * kAim / load);
  change_to(std::min(fits, quality_ - 1.0 / kTenths), now);
}

void TimeBudget::rise(double load, ServerTime now) {
  const bool is_far = load < kFarTooFast;
  if (frames_ms_.size() < (is_new_ ? kEnoughToFall : kEnough)) return;
  if (changed_ && now - *changed_ < (is_far ? kRest : std::max(kRest, patience_))) return;
  const double fits = quality_of_cost(ladder_->at(quality_).cost *
                                      (is_new_ ? kAim / load : std::min(kAim / load, kMostRise)));
  if (fits <= quality_) return;
  if (is_far) patience_ = kRest;
  risen_ = now;
  change_to(fits, now);
}

QualityPoint TimeBudget::plan(ServerTime now) {
  if (!target_) return ladder_->at(limits_.most);
  if (const auto now_load = load()) {
    if (*now_load > kTooSlow)
      fall(*now_load, now);
    else if (*now_load < kTooFast)
      rise(*now_load, now);
  }
  return ladder_->at(quality_);
}

}  // namespace macula::session
