#include "tests/bench/tradeoff_ladder.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "shared/base/text.h"
#include "tests/bench/tradeoff_cases.h"
#include "tests/bench/tradeoff_front.h"

namespace macula::bench {
namespace {

/// A server turns knobs and the scale; the grid's curve and the codec are set elsewhere.
bool may_be_a_step(const std::string& config) {
  const auto words = kernels::parse_knobs(config);
  return words && std::ranges::none_of(*words, [](const kernels::KnobValue& word) {
           return word.name == "grid" || word.name == "model" || word.name == "inner" ||
                  word.name == "outer" || word.name == "floor" || word.name == "jpeg" ||
                  word.name == "depth";
         });
}

struct Sums {
  double cost = 0.0, error = 0.0, flicker = 0.0;  ///< of logarithms
  std::set<std::string> scenes;
};

std::string scenes_of(std::span<const Fields> rows) {
  std::set<std::string> names;
  for (const Fields& row : rows) names.insert(text_in(row, "scene"));
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "\"" : ", \"") + name + "\"";
  return text;
}

/// Steps differ by at least this factor in cost: what lies nearer is a measurement's noise.
constexpr double kLeastFactor = 1.1;
/// And a step has at most this share of the error below it: what lies nearer can't be told apart on
/// another scene, and between two steps the periphery's resolution is carried on anyway.
constexpr double kMostErrorShare = 0.85;
/// The last step is the cheapest one whose error is at most this much of the least.
constexpr double kAsGood = 1.02;

/// Below the steps of a display; of nothing there is no logarithm.
constexpr double kLeastFlicker = 1e-4;

/// Whether two steps differ in the periphery's resolution alone.
bool has_knobs_of(const LadderStep& a, const LadderStep& b) {
  const auto knobs = [](const LadderStep& step) {
    auto words = kernels::parse_knobs(step.config).value_or(kernels::KnobValues{});
    std::erase_if(words, [](const kernels::KnobValue& word) { return word.name == "scale"; });
    return words;
  };
  return knobs(a) == knobs(b);
}

/// Of steps from cheap to dear, those that are worth their cost; the cheapest and the best stay.
/// Where only the resolution changes, its whole range stays: what lies between the ends of a range
/// costs what the ladder says, and a jump to other knobs begins where it ends.
std::vector<LadderStep> far_apart(std::span<const LadderStep> steps) {
  std::vector<LadderStep> kept;
  double worth_rmse =
      std::numeric_limits<double>::infinity();  // of the last that is worth its cost
  bool is_end = false;                          // whether kept.back() is but an end
  for (const LadderStep& step : steps) {
    const bool is_worth = step.rmse <= kMostErrorShare * worth_rmse;
    const bool has_same_knobs = !kept.empty() && has_knobs_of(step, kept.back());
    if (!is_worth && !has_same_knobs) continue;
    if (is_end && has_same_knobs) kept.pop_back();
    kept.push_back(step);
    is_end = !is_worth;
    if (is_worth) worth_rmse = step.rmse;
  }
  if (kept.empty()) return kept;
  const double good = kAsGood * steps.back().rmse;
  const auto last =
      std::ranges::find_if(steps, [&](const LadderStep& step) { return step.rmse <= good; });
  if (last->rmse < kept.back().rmse) kept.push_back(*last);
  return kept;
}

}  // namespace

std::vector<LadderStep> ladder_steps(std::span<const Fields> rows) {
  std::map<std::string, Sums> configs;
  std::set<std::string> scenes;
  for (const Fields& row : rows) {
    scenes.insert(text_in(row, "scene"));
    const std::string config = text_in(row, "config");
    const double error = number_in(row, "rmse_ew");
    if (!may_be_a_step(config) || !(error > 0.0)) continue;
    Sums& sums = configs[config];
    sums.cost += std::log(number_in(row, "cpu_ms"));
    sums.error += std::log(error);
    sums.flicker += std::log(std::max(number_in(row, "flicker_t1"), kLeastFlicker));
    sums.scenes.insert(text_in(row, "scene"));
  }
  std::vector<LadderStep> all;
  std::vector<CostAndError> points;
  for (const auto& [config, sums] : configs) {
    if (sums.scenes != scenes) continue;
    const auto n = static_cast<double>(scenes.size());
    all.push_back({config, std::exp(sums.cost / n), std::exp(sums.error / n)});
    points.push_back({all.back().cost_ms, std::hypot(all.back().rmse, std::exp(sums.flicker / n))});
  }
  std::vector<LadderStep> steps;
  for (const std::size_t i : pareto_front(points)) {
    if (!steps.empty() && all[i].cost_ms < kLeastFactor * steps.back().cost_ms) {
      steps.back() = all[i];  // as cheap as the one below, and better
      continue;
    }
    steps.push_back(all[i]);
  }
  return far_apart(steps);
}

double kendall_tau(std::span<const double> a, std::span<const double> b, double share) {
  int balance = 0, pairs = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (std::max(a[i], a[j]) <= (1.0 + share) * std::min(a[i], a[j])) continue;
      ++pairs;
      const double product = (a[i] - a[j]) * (b[i] - b[j]);
      balance += product > 0.0 ? 1 : (product < 0.0 ? -1 : 0);
    }
  }
  return pairs > 0 ? static_cast<double>(balance) / pairs : 1.0;
}

EstimateCheck check_estimates(std::span<const Fields> rows, const std::string& scene) {
  constexpr double kTold = 0.05;  // what references tell apart
  std::vector<Fields> others, here;
  for (const Fields& row : rows) (text_in(row, "scene") == scene ? here : others).push_back(row);
  std::vector<double> truth, estimates;
  EstimateCheck check;
  for (const LadderStep& step : ladder_steps(others)) {
    for (const Fields& row : here) {
      if (text_in(row, "config") != step.config) continue;
      truth.push_back(number_in(row, "rmse_ew"));
      estimates.push_back(number_in(row, "rmse_estimated"));
      const double ratio = estimates.back() / truth.back();
      constexpr double kWithin = 0.3;
      check.share_within_30 += std::abs(ratio - 1.0) <= kWithin ? 1.0 : 0.0;
      check.worst_factor = std::max({check.worst_factor, ratio, 1.0 / ratio});
    }
  }
  check.steps = static_cast<int>(truth.size());
  if (check.steps == 0) return check;
  check.share_within_30 /= check.steps;
  check.kendall_tau = kendall_tau(truth, estimates, kTold);
  return check;
}

Result<void> write_ladder(const std::string& folder, const std::string& kernel,
                          std::span<const Fields> rows, const std::string& command) {
  const std::vector<LadderStep> steps = ladder_steps(rows);
  if (steps.size() < 2)
    return base::bad_input(base::concat("kernel ", kernel, " has ", steps.size(), " steps"),
                           "--ladders", "measure more configurations on every scene");
  const double cheapest = steps.front().cost_ms, dearest = steps.back().cost_ms;
  std::ostringstream text;
  text.precision(4);
  text << "# Quality ladder of kernel " << kernel
       << ": what no other configuration beats in both time and what is seen\n# "
       << "(error and flicker together).\n# " << command << "\n"
       << "# quality: 0 to 10, the logarithm of cost; scale: of the periphery's resolution;\n"
       << "# cost: of a frame over the dearest step's; rmse: display-linear, as the eye weighs it. "
          "Means over\n# the scenes.\n"
       << "kernel = \"" << kernel << "\"\nscenes = [" << scenes_of(rows) << "]\n";
  for (const LadderStep& step : steps) {
    auto settings = parse_frame_settings(step.config);
    if (!settings) return base::forward(settings);
    text << "\n[[step]]\nquality = "
         << std::round(1e3 * 10.0 * std::log(step.cost_ms / cheapest) /
                       std::log(dearest / cheapest)) /
                1e3
         << "\nscale = " << settings->scale << "\nknobs = \"" << kernels::text_of(settings->knobs)
         << "\"\ncost = " << step.cost_ms / dearest << "\nrmse = " << step.rmse << "\n";
  }
  std::error_code ignored;  // a folder that cannot be made shows when it is written to
  std::filesystem::create_directories(folder, ignored);
  const std::string path = base::concat(folder, "/", kernel, ".toml");
  std::ofstream file(path, std::ios::trunc);
  file << text.str();
  file.close();
  if (!file)
    return base::bad_input("cannot be written", path, "give a folder that exists and has room");
  return {};
}

}  // namespace macula::bench
