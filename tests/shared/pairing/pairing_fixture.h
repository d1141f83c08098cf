// Random bytes from a seed, and a guest and a host that talk to each other directly.
#pragma once

#include <cstdint>
#include <memory>
#include <random>

#include "shared/pairing/guest.h"
#include "shared/pairing/host.h"

namespace macula::pairing {

inline Random seeded_random(std::uint64_t seed) {
  return [engine = std::make_shared<std::mt19937_64>(seed)](std::span<unsigned char> bytes) {
    for (unsigned char& byte : bytes) byte = static_cast<unsigned char>((*engine)());
  };
}

inline Identity identity(unsigned char fill, std::string name) {
  Identity made;
  made.key.fill(fill);
  made.name = std::move(name);
  return made;
}

inline const Identity kServer = identity(0x51, "server"), kHeadset = identity(0xC1, "headset"),
                      kStranger = identity(0xE5, "stranger");

/// A code that is not `right`.
inline Code wrong_code(const Code& right, int which = 0) {
  const int digits = (std::stoi(right.digits()) + 1 + which) % 1'000'000;
  std::string text = std::to_string(digits);
  return *Code::parse(std::string(Code::kDigits - text.size(), '0') + text);
}

struct Outcome {
  std::optional<Identity> host_paired_with, guest_paired_with;
  std::string failure;
};

/// Carries messages between the two until neither has more to say.
inline Outcome converse(Guest& guest, Host& host, Nanoseconds now, const Host::Peer& peer = "a") {
  Outcome outcome;
  std::string to_host = guest.greeting();
  while (!to_host.empty()) {
    Host::Answer answer = host.handle(peer, to_host, now);
    to_host.clear();
    if (answer.paired) outcome.host_paired_with = answer.paired;
    const GuestStep step = guest.handle(answer.bytes);
    if (const auto* say = std::get_if<Say>(&step)) to_host = say->bytes;
    if (const auto* paired = std::get_if<Paired>(&step)) outcome.guest_paired_with = paired->host;
    if (const auto* failed = std::get_if<Failed>(&step)) outcome.failure = failed->text;
  }
  return outcome;
}

}  // namespace macula::pairing
