#include "tests/server/session/simulation.h"
#include "tests/support/fault_table.h"

#include <gtest/gtest.h>
#include <tuple>

namespace macula::session::test {
namespace {

constexpr double kLivenessMs = 1200.0;

/// Two to four seconds of trouble drawn from the seed.
void make_trouble(Simulation& world) {
  const Faults faults{world.uniform(0.0, 0.4),  world.uniform(0.0, 0.3),
                      world.uniform(0.0, 0.2),  world.uniform(0.0, 0.01),
                      world.uniform(0.1, 10.0), world.uniform(20.0, 100.0)};
  world.set_faults(faults);
  const int blows = static_cast<int>(world.uniform(2.0, 5.0));
  for (int blow = 0; blow < blows; ++blow) {
    world.run_for(world.uniform(100.0, 800.0));
    const double kind = world.uniform(0.0, 1.0);
    if (kind < 0.25) world.restart_server();
    if (kind >= 0.25 && kind < 0.5) world.restart_client();
    if (kind >= 0.5 && kind < 0.7) world.silence_client(world.uniform(50.0, 4000.0));
    if (kind >= 0.7 && kind < 0.85) world.jump_server_clock(world.uniform(10.0, 3.6e6));
  }
  world.run_for(world.uniform(100.0, 500.0));
}

// The thread sanitizer takes a hundred times as long and has but one thread to watch here.
#if defined(__SANITIZE_THREAD__)
constexpr std::uint64_t kSeeds = 200;
#elif defined(__SANITIZE_ADDRESS__)
constexpr std::uint64_t kSeeds = 1000;
#else
constexpr std::uint64_t kSeeds = 10'000;
#endif

TEST(Simulation, AHealthyLinkShowsAFrameForNearlyEveryRenderPeriod) {
  Simulation world(1);
  world.run_for(5000.0);
  EXPECT_EQ(world.violation(), "");
  // Rendering takes 15.5 ms on average and views come every 13.9 ms: about 36 frames a second.
  EXPECT_GT(world.frames_shown(), 130U);
}

TEST(Simulation, SurvivesTenThousandSeedsOfTrouble) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Simulation world(seed);
    world.run_for(200.0);
    make_trouble(world);
    // Faults end: a client that still keeps silent is not a fault of the network.
    world.set_faults({});
    world.silence_client(0.0);
    const double end_of_faults = world.now_ms();
    const std::uint64_t shown_before = world.frames_shown();
    world.run_for(kLivenessMs);
    ASSERT_EQ(world.violation(), "");
    ASSERT_GT(world.frames_shown(), shown_before) << "no frame for 1.2 s, seed " << seed;
    ASSERT_GT(world.newest_shown_ms(), end_of_faults) << "seed " << seed;
    ASSERT_LT(world.events_pending(), 100U) << "seed " << seed;
  }
  macula::test::note_fault("simulated troubles, both sides", "10,000 seeds, alive within 1 s after",
                           std::to_string(kSeeds) + " seeds without a violation");
}

TEST(Simulation, TheSameSeedGivesTheSameHistory) {
  const auto history = [](std::uint64_t seed) {
    Simulation world(seed);
    make_trouble(world);
    const SessionCounters totals = world.table().totals();
    return std::tuple(world.frames_shown(), world.now_ms(), totals.views, totals.frames_lost);
  };
  EXPECT_EQ(history(77), history(77));
  EXPECT_NE(history(77), history(78));
}

/// The twin that must fail: credit that is never returned for lost frames deadlocks within 50
/// seeds.
TEST(Simulation, WouldNoticeCreditThatIsNeverReturned) {
  SessionRules never;
  never.least_loss_timeout = std::chrono::hours{1};
  int deadlocks = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Simulation world(seed, never);
    world.run_for(200.0);
    world.set_faults({.drop = 1.0});
    world.run_for(300.0);
    world.set_faults({});
    const std::uint64_t shown_before = world.frames_shown();
    world.run_for(kLivenessMs);
    deadlocks += world.frames_shown() == shown_before ? 1 : 0;
  }
  EXPECT_GT(deadlocks, 0);
}

}  // namespace
}  // namespace macula::session::test
