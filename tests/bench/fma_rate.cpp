#include "tests/bench/fma_rate.h"

#include <algorithm>
#include <ctime>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/fma_rate.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace macula::bench::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Runs `rounds` rounds of kChains vectors each; returns the lanes' multiply-adds in them. The sum
/// keeps the loop from being left out. Twelve chains cover four cycles of latency on two units.
HWY_ATTR double multiply_add(int rounds, float& sum) {
  constexpr int kChains = 12;
  const hn::ScalableTag<float> d;
  const auto factor = hn::Set(d, 0.5F), term = hn::Set(d, sum);
  auto a = term, b = a, c = a, e = a, f = a, g = a, h = a, i = a, j = a, k = a, l = a, m = a;
  for (int round = 0; round < rounds; ++round) {
    a = hn::MulAdd(a, factor, term), b = hn::MulAdd(b, factor, term);
    c = hn::MulAdd(c, factor, term), e = hn::MulAdd(e, factor, term);
    f = hn::MulAdd(f, factor, term), g = hn::MulAdd(g, factor, term);
    h = hn::MulAdd(h, factor, term), i = hn::MulAdd(i, factor, term);
    j = hn::MulAdd(j, factor, term), k = hn::MulAdd(k, factor, term);
    l = hn::MulAdd(l, factor, term), m = hn::MulAdd(m, factor, term);
#if HWY_COMPILER_GCC
    // Chains of equal values would otherwise be one.
    asm volatile("" : "+x"(a), "+x"(b), "+x"(c), "+x"(e), "+x"(f), "+x"(g));
    asm volatile("" : "+x"(h), "+x"(i), "+x"(j), "+x"(k), "+x"(l), "+x"(m));
#endif
  }
  const auto all = hn::Add(
      hn::Add(hn::Add(a, b), hn::Add(c, e)),
      hn::Add(hn::Add(hn::Add(f, g), hn::Add(h, i)), hn::Add(hn::Add(j, k), hn::Add(l, m))));
  sum = hn::GetLane(hn::SumOfLanes(d, all));
  return static_cast<double>(kChains) * static_cast<double>(hn::Lanes(d)) * rounds;
}

}  // namespace macula::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::bench {

HWY_EXPORT(multiply_add);

namespace {

double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

double fma_lanes_per_cpu_s(scheduling::TileScheduler& scheduler) {
  constexpr int kTries = 8, kRounds = 2'000'000;
  std::vector<double> rates(static_cast<std::size_t>(scheduler.threads()) * kTries);
  scheduler.run(rates.size(), [&](std::size_t i) {
    float sum = 1.0F;
    const double begin = thread_cpu_s();
    const double done = HWY_DYNAMIC_DISPATCH(multiply_add)(kRounds, sum);
    const double rate = done / (thread_cpu_s() - begin);
    rates[i] = sum > 0.0F ? rate : 0.0;
  });
  return *std::ranges::max_element(rates);
}

}  // namespace macula::bench
#endif
