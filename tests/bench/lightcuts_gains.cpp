#include "tests/bench/lightcuts_gains.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "tests/bench/curve.h"

namespace macula::bench {
namespace {

constexpr const char* kPlain = "sl";

enum class Read { ErrorOverTime, TimeOverError };

class Reader {
 public:
  explicit Reader(std::span<const Judged> all) : all_(all) {}

  /// A baseline's value at `x`, over `by`.
  double read(const std::string& baseline, double Judged::*error, Read what, double x, double by) {
    const std::vector<Curve::Point> points = falling(baseline, error, what);
    if (points.empty()) return std::nan("");
    const Curve curve(points);
    const std::optional<double> value = curve.spans(x) ? curve.at(x) : std::nullopt;
    if (!value) ++not_read_;
    return value ? *value / by : std::nan("");
  }
  int not_read() const { return not_read_; }

 private:
  /// Who has time for many samples may take fewer: a point that errs more than a faster one counts
  /// as that one over time, and for nothing over errors.
  std::vector<Curve::Point> falling(const std::string& baseline, double Judged::*error,
                                    Read what) const {
    std::vector<Curve::Point> points;
    for (const Judged& one : all_)
      if (one.name == baseline) points.push_back({one.cpu_ms, one.*error});
    std::ranges::sort(points, {}, &Curve::Point::x);
    std::vector<Curve::Point> kept;
    double least = INFINITY;
    for (const auto& [time_ms, err] : points) {
      const bool is_better = err < least;
      least = std::min(least, err);
      if (what == Read::ErrorOverTime) kept.push_back({time_ms, least});
      if (what == Read::TimeOverError && is_better) kept.push_back({err, time_ms});
    }
    return kept;
  }

  std::span<const Judged> all_;
  int not_read_ = 0;
};

}  // namespace

LightcutsGains gains_of(const Judged& one, std::span<const Judged> all) {
  Reader reader(all);
  const auto gain = [&](const std::string& baseline, double Judged::*error) {
    return reader.read(baseline, error, Read::ErrorOverTime, one.cpu_ms, one.*error);
  };
  LightcutsGains gains;
  gains.gain_f25 = gain(one.baseline, &Judged::mse_f25);
  gains.gain_out25 = gain(one.baseline, &Judged::mse_out25);
  gains.speed_f25 =
      reader.read(one.baseline, &Judged::mse_f25, Read::TimeOverError, one.mse_f25, one.cpu_ms);
  gains.plain_gain_f25 = gain(kPlain, &Judged::mse_f25);
  gains.plain_gain_out25 = gain(kPlain, &Judged::mse_out25);
  gains.not_read = reader.not_read();
  return gains;
}

bool reaches_all(const std::string& baseline, std::span<const Judged> all) {
  double longest_ms = 0.0, least_error = INFINITY, time_ms = 0.0, error = INFINITY;
  bool is_read = false;
  for (const Judged& one : all) {
    if (one.name == baseline) {
      longest_ms = std::max(longest_ms, one.cpu_ms);
      least_error = std::min(least_error, one.mse_f25);
    } else if (one.name != one.baseline) {
      const bool is_held = one.baseline == baseline;
      if (is_held || baseline == kPlain) is_read = true, time_ms = std::max(time_ms, one.cpu_ms);
      if (is_held) error = std::min(error, one.mse_f25);
    }
  }
  return is_read && longest_ms >= time_ms && least_error <= error;
}

}  // namespace macula::bench
