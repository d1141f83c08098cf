#include "shared/pairing/guest.h"

#include <utility>

#include "shared/base/text.h"
#include "shared/pairing/run.h"

namespace macula::pairing {

using base::concat;

namespace {
constexpr const char* kOtherVersion =
    "the server pairs by another version: install the same release on both machines";
}

Guest::Guest(Code code, Identity own, Random random)
    : code_(std::move(code)),
      own_(std::move(own)),
      random_(std::move(random)),
      nonce_(draw_nonce(random_)) {}

std::string Guest::greeting() const {
  return encode(Greeting{nonce_});
}

GuestStep Guest::handle(std::string_view bytes) {
  if (const auto version = version_of(bytes); version && *version != kVersion)
    return Failed{kOtherVersion};
  const auto message = decode(bytes);
  if (!message) return Ignored{};
  return std::visit([this](const auto& one) { return on(one); }, *message);
}

/// A second Offer would be a second guess at our code: only the first is answered.
GuestStep Guest::on(const Offer& offer) {
  if (key_) return Ignored{};
  const std::string session = session_of(nonce_, offer.nonce);
  const Scalar scalar = draw_scalar(random_);
  const Share share = cpace_share(cpace_generator({code_.digits(), kChannel, session}), scalar);
  key_ = key_of(session, scalar, offer.share, share, offer.share);
  if (!key_) return Failed{"who answers is no Macula server: check the address"};
  return Say{encode(Proof{share, seal(own_, *key_, Direction::FromGuest)})};
}

GuestStep Guest::on(const Grant& grant) {
  if (!key_) return Ignored{};
  auto host = open_seal(grant.sealed, *key_, Direction::FromHost);
  if (host) return Paired{std::move(*host)};
  return Failed{
      "who answers does not know the code: somebody may stand between this machine and the server; "
      "nothing was changed, begin again with a new code"};
}

GuestStep Guest::on(const Denial& denial) {
  switch (denial.reason) {
    case DenialReason::WrongVersion:
      return Failed{kOtherVersion};
    case DenialReason::WrongCode:
      return Failed{"the code is wrong: type the six digits that the server shows"};
    case DenialReason::LockedOut:
      return Failed{concat("too many wrong codes: in ", denial.wait_s,
                           " s the server shows another, if it is still pairing")};
    case DenialReason::NoRun:
      return Failed{"the server took too long or has forgotten this try: begin again"};
    case DenialReason::Closed:
      return Failed{"the server is no longer pairing: run 'macula-server pair' there again"};
  }
  return Ignored{};
}

}  // namespace macula::pairing
