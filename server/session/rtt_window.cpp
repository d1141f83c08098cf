#include "server/session/rtt_window.h"

#include <algorithm>

namespace macula::session {
namespace {
constexpr Nanoseconds kSpan = std::chrono::seconds{10};
constexpr std::size_t kMostSamples = 64;
}  // namespace

void RttWindow::add(Nanoseconds rtt, ServerTime at) {
  if (rtt < Nanoseconds::zero()) return;
  // A newer sample that is not larger makes the older ones irrelevant for every later minimum.
  while (!rising_.empty() && rising_.back().rtt >= rtt) rising_.pop_back();
  rising_.push_back({rtt, at});
  while (at - rising_.front().at > kSpan || rising_.size() > kMostSamples) rising_.pop_front();
}

std::optional<Nanoseconds> RttWindow::least(ServerTime now) const {
  const auto fresh = std::find_if(rising_.begin(), rising_.end(),
                                  [&](const Sample& s) { return now - s.at <= kSpan; });
  if (fresh == rising_.end()) return std::nullopt;
  return fresh->rtt;
}

}  // namespace macula::session
