#include "server/session/time_budget.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace macula::session {
namespace {

// Above target x kTooSlow quality falls, below target x kTooFast it rises. A tenth of quality
// differs in cost by less than 5 % on ladders of two decades: a step taken for one reason never
// gives the other reason at once, so a steady load settles.
constexpr double kTooSlow = 1.06, kTooFast = 0.94, kAim = 1.0;
/// Beyond these something has changed: then it falls at once, and rises in strides.
constexpr double kFarTooSlow = 1.25, kFarTooFast = 0.6;
constexpr double kMostRise = 1.5;  ///< of the cost, in one change
constexpr std::size_t kRemembered = 40, kEnough = 12, kEnoughToFall = 4, kJump = 7;
constexpr Nanoseconds kRest = std::chrono::seconds{1};
/// For so long after a rise that did not hold the next ones go half way to where it led.
constexpr Nanoseconds kFirstCaution = std::chrono::seconds{4};
constexpr Nanoseconds kLongestCaution = std::chrono::seconds{16};
/// Where even the quickest of the first few frames takes so much longer, no more need be seen.
constexpr double kHopeless = 3.0;
/// Where it begins: low enough for most scenes and machines to show soon how fast they are.
constexpr double kFirstQuality = 2.0;
/// A rise that has to be taken back so soon did not hold.
constexpr Nanoseconds kProof = std::chrono::seconds{2};
constexpr double kTenths = 10.0;
constexpr double kTenthIsWhole = 1e-6;  ///< of a tenth, that doubles lose of whole ones

/// The lower one of two in the middle. Not empty.
double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

TimeBudget::TimeBudget(std::optional<Nanoseconds> target,
                       std::shared_ptr<const QualityLadder> ladder)
    : target_(target),
      ladder_(ladder != nullptr ? std::move(ladder)
                                : std::make_shared<const QualityLadder>(QualityLadder::of_scale())),
      costs_(ladder_->steps().size()),
      quality_(target ? kFirstQuality : kBestQuality),
      caution_(kFirstCaution) {}

void TimeBudget::set_limits(const Limits& limits) {
  limits_ = limits;
  const double held = std::clamp(quality_, limits.least, limits.most);
  if (held != quality_) frames_ms_.clear();
  quality_ = held;
}

void TimeBudget::on_frame(Nanoseconds render) {
  frames_ms_.push_back(units::to_ms(render));
  if (frames_ms_.size() > kRemembered) frames_ms_.pop_front();
  if (has_jumped()) frames_ms_.erase(frames_ms_.begin(), frames_ms_.end() - kJump);
}

/// Whether the newest frames are all far from those before: then only they tell what is now.
bool TimeBudget::has_jumped() const {
  if (frames_ms_.size() <= kJump) return false;
  const auto newest = frames_ms_.end() - kJump;
  const double before = median({frames_ms_.begin(), newest});
  const auto [least, most] = std::minmax_element(newest, frames_ms_.end());
  return *least > kFarTooSlow * before || *most < kFarTooFast * before;
}

std::optional<double> TimeBudget::load() const {
  // The very first frame also makes what all others have.
  if (frames_ms_.size() < (is_new_ ? 2U : 1U)) return std::nullopt;
  if (frames_ms_.size() < kEnoughToFall) {
    const double quickest = *std::ranges::min_element(frames_ms_) / units::to_ms(*target_);
    return quickest > kHopeless ? std::optional(quickest) : std::nullopt;
  }
  return median({frames_ms_.begin(), frames_ms_.end()}) / units::to_ms(*target_);
}

double TimeBudget::quality_of_time(double times, double most_rise, ServerTime now) const {
  const QualityPoint here = ladder_->at(quality_);
  double best = kLeastQuality;
  for (double tenth = 0.0; tenth <= kTenths * kBestQuality; tenth += 1.0) {
    const QualityPoint there = ladder_->at(tenth / kTenths);
    if (there.cost <= here.cost * most_rise &&
        there.cost * costs_.ratio(here.step, there.step, now) <= here.cost * times)
      best = there.quality;
  }
  return best;
}

void TimeBudget::learn(double load, ServerTime now) {
  if (!foretold_ || frames_ms_.size() < kEnoughToFall) return;
  costs_.learn(foretold_->from, ladder_->at(quality_).step, load / foretold_->load, now);
  foretold_.reset();
}

void TimeBudget::change_to(double quality, double load, ServerTime now) {
  const double next = std::clamp(quality, limits_.least, limits_.most);
  if (next == quality_) return;
  const QualityPoint from = ladder_->at(quality_), to = ladder_->at(next);
  foretold_.reset();
  if (from.step != to.step && frames_ms_.size() >= kEnoughToFall)
    foretold_ = {from.step, load * to.cost / from.cost};
  quality_ = next;
  frames_ms_.clear();
  is_new_ = false;
  changed_ = now;
}

void TimeBudget::fall(double load, ServerTime now) {
  // Few frames can have been kept from their time by chance: then each must be too slow.
  const bool is_far = load > kFarTooSlow &&
                      (frames_ms_.size() >= kEnough || *std::ranges::min_element(frames_ms_) >
                                                           kFarTooSlow * units::to_ms(*target_));
  const bool is_proving = risen_ && now - *risen_ < kRest && load < kHopeless;
  if ((!is_far || is_proving) && changed_ && now - *changed_ < kRest) return;
  if (risen_ && now - *risen_ < kProof) note_unheld(now);
  change_to(std::min(quality_of_time(kAim / load, 1.0, now), quality_ - 1.0 / kTenths), load, now);
}

/// The rise that led to here did not hold.
void TimeBudget::note_unheld(ServerTime now) {
  if (unheld_) caution_ = std::min(2 * caution_, kLongestCaution);
  unheld_ = {quality_, now};
}

double TimeBudget::held_place(double place, ServerTime now) const {
  if (!unheld_ || now - unheld_->at > caution_) return place;
  const double half_way = std::midpoint(quality_, unheld_->quality);
  return std::min(place, std::floor(kTenths * half_way + kTenthIsWhole) / kTenths);
}

void TimeBudget::rise(double load, ServerTime now) {
  if (frames_ms_.size() < (is_new_ ? kEnoughToFall : kEnough)) return;
  if (changed_ && now - *changed_ < kRest) return;
  if (load < kFarTooFast) unheld_.reset(), caution_ = kFirstCaution;
  const double fits =
      held_place(quality_of_time(kAim / load, is_new_ ? kAim / load : kMostRise, now), now);
  if (fits <= quality_) return;
  risen_ = now;
  change_to(fits, load, now);
}

QualityPoint TimeBudget::plan(ServerTime now) {
  if (!target_) return ladder_->at(limits_.most);
  if (const auto now_load = load()) {
    learn(*now_load, now);
    if (*now_load > kTooSlow)
      fall(*now_load, now);
    else if (*now_load < kTooFast)
      rise(*now_load, now);
  }
  return ladder_->at(quality_);
}

}  // namespace macula::session
