#include "server/session/quality_ladder.h"

#include <algorithm>
#include <cmath>

#include "shared/base/text.h"

namespace macula::session {
namespace {

/// Where knobs change between steps, only the scale can lie between: cost goes about so with it,
/// since the disc of full rate shrinks more slowly than the rest.
constexpr double kCostPerScale = 1.5;
constexpr double kLeastScale = 0.05;

/// From a to b in logarithms; 0, not measured, stays 0.
double between(double a, double b, double share) {
  if (!(a > 0.0 && b > 0.0)) return 0.0;
  return a * std::pow(b / a, share);
}

Result<void> check_step(const QualityStep& step, const QualityStep* below) {
  const auto wrong = [&](const char* what, const char* allowed) -> Result<void> {
    return base::bad_input(base::concat(what, " of the step of quality ", step.quality), "ladder",
                           allowed);
  };
  if (!(step.quality >= kLeastQuality && step.quality <= kBestQuality))
    return wrong("quality", "0 to 10");
  if (!(step.scale > 0.0 && step.scale <= 1.0)) return wrong("scale", "above 0, at most 1");
  if (!(step.cost > 0.0)) return wrong("cost", "above 0");
  if (below == nullptr) return {};
  if (!(step.quality > below->quality)) return wrong("quality", "it rises from step to step");
  if (!(step.cost > below->cost)) return wrong("cost", "it rises from step to step");
  if (step.rmse > 0.0 && !(step.rmse < below->rmse))
    return wrong("rmse", "it falls from step to step");
  return {};
}

}  // namespace

Result<QualityLadder> QualityLadder::create(std::vector<QualityStep> steps) {
  if (steps.size() < 2)
    return base::bad_input(base::concat("has ", steps.size(), " steps"), "ladder", "two or more");
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (auto ok = check_step(steps[i], i == 0 ? nullptr : &steps[i - 1]); !ok)
      return base::forward(ok);
  if (steps.front().quality != kLeastQuality || steps.back().quality != kBestQuality)
    return base::bad_input(
        base::concat("goes from quality ", steps.front().quality, " to ", steps.back().quality),
        "ladder", "from 0 to 10");
  return QualityLadder(std::move(steps));
}

QualityLadder QualityLadder::of_scale() {
  constexpr double kLeast = 0.4;
  return QualityLadder(
      {{kLeastQuality, kLeast, {}, kLeast * kLeast, 0.0}, {kBestQuality, 1.0, {}, 1.0, 0.0}});
}

QualityPoint QualityLadder::at(double wanted) const {
  const double quality = std::clamp(wanted, kLeastQuality, kBestQuality);
  std::size_t upper = 0;
  while (steps_[upper].quality < quality) ++upper;
  const QualityStep& above = steps_[upper];
  QualityPoint point{quality, above.scale, upper, above.cost, above.rmse};
  if (above.quality == quality) return point;
  const QualityStep& below = steps_[upper - 1];
  const double share = (quality - below.quality) / (above.quality - below.quality);
  point.cost = between(below.cost, above.cost, share);
  point.rmse = between(below.rmse, above.rmse, share);
  const bool only_scale = above.knobs == below.knobs;
  point.scale = only_scale
                    ? between(below.scale, above.scale, share)
                    : std::max(above.scale * std::pow(point.cost / above.cost, 1.0 / kCostPerScale),
                               kLeastScale);
  return point;
}

double QualityLadder::quality_for_error(double rmse) const {
  constexpr int kTenths = 100;
  for (int tenth = 0; tenth < kTenths; ++tenth) {
    const double quality = tenth * (kBestQuality / kTenths);
    const double error = at(quality).rmse;
    if (error > 0.0 && error <= rmse) return quality;
  }
  return kBestQuality;
}

}  // namespace macula::session
