#include "server/session/governor.h"

#include <algorithm>

namespace macula::session {
namespace {

/// More than so many losses within the span: colour becomes stateless for a while.
constexpr int kTooManyKeys = 3;
constexpr Nanoseconds kKeySpan = std::chrono::seconds{2}, kStatelessFor = std::chrono::seconds{10};

}  // namespace

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
  quality.scale = std::min(time_.scale(), quality.bytes.scale);
  if (now < stateless_until_) quality.color = Quality::Color::Stateless;
  return quality;
}

}  // namespace macula::session
