#include "shared/pairing/host.h"

#include <algorithm>
#include <utility>

#include "shared/pairing/run.h"

namespace macula::pairing {
namespace {

std::uint16_t whole_seconds(Nanoseconds wait) {
  constexpr std::int64_t kMost = 0xFFFF;
  const auto seconds = std::chrono::ceil<std::chrono::seconds>(wait).count();
  return static_cast<std::uint16_t>(std::clamp<std::int64_t>(seconds, 0, kMost));
}

}  // namespace

Host::Host(const HostRules& rules, Identity own, Random random, Nanoseconds now)
    : rules_(rules),
      own_(std::move(own)),
      random_(std::move(random)),
      code_(Code::draw(random_)),
      closes_(now + rules.window),
      locked_until_(now) {}

std::optional<Code> Host::code(Nanoseconds now) const {
  if (!is_open(now) || is_locked(now)) return std::nullopt;
  return code_;
}

Nanoseconds Host::left(Nanoseconds now) const {
  return is_open(now) ? closes_ - now : Nanoseconds{0};
}

Host::Answer Host::handle(const Peer& peer, std::string_view bytes, Nanoseconds now) {
  if (const auto version = version_of(bytes); version && *version != kVersion)
    return deny(DenialReason::WrongVersion, Nanoseconds{0});
  const auto message = decode(bytes);
  if (!message) {
    ++counters_.malformed;
    return {};
  }
  return std::visit([&](const auto& one) { return on(peer, one, now); }, *message);
}

Host::Answer Host::deny(DenialReason reason, Nanoseconds wait) {
  ++counters_.denied;
  return {encode(Denial{reason, whole_seconds(wait)}), std::nullopt};
}

/// Runs that came to nothing go first, then the oldest.
void Host::make_room(Nanoseconds now) {
  std::erase_if(runs_, [&](const auto& run) { return now - run.second.begun > rules_.run_lasts; });
  if (runs_.size() < rules_.most_runs) return;
  runs_.erase(std::min_element(runs_.begin(), runs_.end(), [](const auto& a, const auto& b) {
    return a.second.begun < b.second.begun;
  }));
}

Host::Answer Host::on(const Peer& peer, const Greeting& greeting, Nanoseconds now) {
  ++counters_.greetings;
  if (!is_open(now)) return deny(DenialReason::Closed, Nanoseconds{0});
  if (is_locked(now)) return deny(DenialReason::LockedOut, locked_until_ - now);
  runs_.erase(peer);
  make_room(now);
  const Nonce nonce = draw_nonce(random_);
  Run run{session_of(greeting.nonce, nonce), draw_scalar(random_), {}, now};
  run.share = cpace_share(cpace_generator({code_.digits(), kChannel, run.session}), run.scalar);
  const Offer offer{nonce, run.share};
  runs_.emplace(peer, std::move(run));
  return {encode(offer), std::nullopt};
}

std::optional<Identity> Host::verify(const Run& run, const Proof& proof, std::string& grant) const {
  const auto key = key_of(run.session, run.scalar, proof.share, proof.share, run.share);
  if (!key) return std::nullopt;
  auto guest = open_seal(proof.sealed, *key, Direction::FromGuest);
  if (guest) grant = encode(Grant{seal(own_, *key, Direction::FromHost)});
  return guest;
}

/// One Proof a run: right or wrong, the run is over.
Host::Answer Host::on(const Peer& peer, const Proof& proof, Nanoseconds now) {
  if (!is_open(now)) return deny(DenialReason::Closed, Nanoseconds{0});
  if (is_locked(now)) return deny(DenialReason::LockedOut, locked_until_ - now);
  auto run = runs_.extract(peer);
  if (run.empty() || now - run.mapped().begun > rules_.run_lasts)
    return deny(DenialReason::NoRun, Nanoseconds{0});
  std::string grant;
  auto guest = verify(run.mapped(), proof, grant);
  if (!guest) return on_wrong_code(now);
  paired_ = true;
  runs_.clear();
  return {std::move(grant), std::move(guest)};
}

Host::Answer Host::on_wrong_code(Nanoseconds now) {
  ++counters_.wrong_codes;
  if (++wrong_ < rules_.tries) return deny(DenialReason::WrongCode, Nanoseconds{0});
  // Every run under way was made with the burnt code.
  wrong_ = 0;
  runs_.clear();
  code_ = Code::draw(random_);
  locked_until_ = now + rules_.lockout;
  return deny(DenialReason::LockedOut, rules_.lockout);
}

}  // namespace macula::pairing
