// What reaches the pairing socket: a host and a guest in the midst of a run, fed with anything.
#include "tests/fuzz/fuzz_target.h"
#include "tests/shared/pairing/pairing_fixture.h"

namespace macula::fuzz {

using namespace pairing;

namespace {

constexpr Nanoseconds kNow{0};

/// Both sides in the midst of a run; copied for every input.
struct Run {
  Host host{{}, kServer, seeded_random(1), kNow};
  Guest fresh{*host.code(kNow), kHeadset, seeded_random(2)}, guest = fresh;
  Run() { (void)guest.handle(host.handle("peer", guest.greeting(), kNow).bytes); }
};

}  // namespace

void try_input(Input input) {
  static const Run started;
  Run run = started;
  const std::string_view bytes = as_text(input);
  if (const auto message = decode(bytes))
    require(encode(*message) == bytes, "a message has two spellings");
  (void)run.fresh.handle(bytes);
  require(!std::holds_alternative<Paired>(run.guest.handle(bytes)), "a guest paired with noise");
  require(!run.host.handle("peer", bytes, kNow).paired, "a host paired with noise");
  (void)open_seal(bytes, {}, Direction::FromGuest);
}

std::vector<std::string> seeds() {
  Host host({}, kServer, seeded_random(3), kNow);
  Guest guest(*host.code(kNow), kHeadset, seeded_random(4));
  const std::string offer = host.handle("peer", guest.greeting(), kNow).bytes;
  const std::string proof = std::get<Say>(guest.handle(offer)).bytes;
  const std::string grant = host.handle("peer", proof, kNow).bytes;
  return {guest.greeting(),
          offer,
          proof,
          grant,
          encode(Denial{DenialReason::LockedOut, 60}),
          seal(kHeadset, {}, Direction::FromGuest)};
}

}  // namespace macula::fuzz
