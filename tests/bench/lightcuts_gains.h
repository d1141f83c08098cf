// What a method gains against a baseline of stochastic lightcuts: read off the baseline's own curve
// over its numbers of samples, between points that were measured and never beyond them, each at its
// best: a smoothed baseline's errors may rise where its memory ends. Pure.
#pragma once

#include <span>
#include <string>

namespace macula::bench {

/// One point: a method, or a baseline at one number of samples.
struct Judged {
  std::string name;      ///< a baseline's points share theirs
  std::string baseline;  ///< whose curve it is held against; its own name: a point of that
  double cpu_ms = 0.0, mse_f25 = 0.0, mse_out25 = 0.0;
};

/// The baseline's error at equal time over the method's; its time at equal error in F25; and the
/// first two against sl whatever the baseline is. Not a number where it cannot be read off.
struct LightcutsGains {
  double gain_f25 = 0.0, gain_out25 = 0.0, speed_f25 = 0.0;
  double plain_gain_f25 = 0.0, plain_gain_out25 = 0.0;
  int not_read = 0;  ///< of these that lie beyond a curve that was measured
};
LightcutsGains gains_of(const Judged& one, std::span<const Judged> all);

/// Whether the curve reaches every time and every error in F25 that is read off it for the methods
/// in `all`: more samples than these would tell nothing. Not where nothing is.
bool reaches_all(const std::string& baseline, std::span<const Judged> all);

}  // namespace macula::bench
