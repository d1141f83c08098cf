#include "server/session/byte_budget.h"

#include <algorithm>
#include <cmath>

namespace macula::session {
namespace {

/// A frame waits for its turn, is sent, and the one before it may be late: its time on the link
/// counts about so often in its age.
constexpr double kTurns = 2.5;
constexpr double kUsedShare = 0.85;  ///< of the link: what is measured is never quite there
constexpr double kLeastTime_ms = 5.0, kMostTime_ms = 50.0;
/// Of what a frame takes without the link: a goal that this misses is not met by sending less, and
/// on a busy machine an acknowledgement alone takes longer than kLeastTime_ms.
constexpr double kLeastShare = 0.1;
/// A whole, still H.264 frame at the coarsest quantisers has about so many bytes a cell.
constexpr double kTooFew_bytes_per_cell = 0.006, kPlenty_bytes_per_cell = 0.02;
constexpr double kStep = 0.8;   ///< of the scale, down or up
constexpr double kRise = 1.15;  ///< of the bytes, a frame
constexpr double kSmoothing = 0.2;
constexpr Nanoseconds kRest = std::chrono::seconds{2};
constexpr double kDepthShare = 0.35, kDepthShareToRefine = 0.25;
/// Fine and coarse depth compress unlike: a quarter of the samples has about a third of the bytes.
constexpr double kDepthShrinks = 3.0;

double depth_at(double full_bytes, int divisor) {
  return full_bytes / std::pow(kDepthShrinks, std::log2(static_cast<double>(divisor)));
}

}  // namespace

void ByteBudget::on_encoded(const EncodedSize& size) {
  const double ms = units::to_ms(size.work);
  work_ms_ = work_ms_ == 0.0 ? ms : work_ms_ + kSmoothing * (ms - work_ms_);
  last_bytes_ = static_cast<double>(size.bytes());
  full_depth_bytes_ = static_cast<double>(size.depth_bytes) *
                      std::pow(kDepthShrinks, std::log2(static_cast<double>(size.depth_divisor)));
  cells_ = static_cast<double>(size.cells);
}

double ByteBudget::bytes_a_frame(const LinkState& link) const {
  const double fixed_ms = work_ms_ + units::to_ms(link.least_rtt + link.clients_own);
  const double least_ms = std::clamp(kLeastShare * fixed_ms, kLeastTime_ms, kMostTime_ms);
  const double time_ms =
      std::clamp((units::to_ms(*goal_) - fixed_ms) / kTurns, least_ms, kMostTime_ms);
  return kUsedShare * *link.bytes_per_s * 1e-3 * time_ms;
}

void ByteBudget::choose_divisor(double bytes) {
  while (divisor_ < 8 && depth_at(full_depth_bytes_, divisor_) > kDepthShare * bytes) divisor_ *= 2;
  if (divisor_ > 1 && depth_at(full_depth_bytes_, divisor_ / 2) < kDepthShareToRefine * bytes) {
    divisor_ /= 2;
  }
}

void ByteBudget::choose_scale(double color_bytes, ServerTime now) {
  if (cells_ <= 0.0) return;
  if (!scale_changed_) scale_changed_ = now;  // the quantiser and the rate go first
  if (now - *scale_changed_ < kRest) return;
  const double per_cell = color_bytes / cells_;
  double wanted = scale_;
  if (per_cell < kTooFew_bytes_per_cell) wanted = std::max(kLeastScale, scale_ * kStep);
  if (per_cell > kPlenty_bytes_per_cell) wanted = std::min(1.0, scale_ / kStep);
  if (wanted == scale_) return;
  scale_ = wanted;
  scale_changed_ = now;
}

BytePlan ByteBudget::plan(const LinkState& link, ServerTime now) {
  if (!goal_ || !link.bytes_per_s || work_ms_ == 0.0) return {};
  const double fits = bytes_a_frame(link);
  allowed_bytes_ = allowed_bytes_ == 0.0 ? fits : std::min(fits, kRise * allowed_bytes_);
  const double bytes = std::max(allowed_bytes_, static_cast<double>(kLeastBytes));
  choose_divisor(bytes);
  const double color = std::max(bytes - depth_at(full_depth_bytes_, divisor_), 0.5 * bytes);
  choose_scale(color, now);
  BytePlan plan;
  plan.color_bytes = static_cast<std::size_t>(color);
  plan.depth_divisor = divisor_;
  // A frame need not take all it may: the link rests from what the last one took.
  plan.least_interval =
      units::from_s(std::min(bytes, last_bytes_) / (kUsedShare * *link.bytes_per_s));
  plan.scale = scale_;
  return plan;
}

}  // namespace macula::session
