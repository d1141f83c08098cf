#include "tests/bench/tradeoff_front.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "tests/bench/curve.h"

namespace macula::bench {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

bool is_uniform(const Fields& row) {
  const Value* uniform = nullptr;
  for (const auto& [key, value] : row)
    if (key == "uniform") uniform = &value;
  return uniform != nullptr && std::get_if<bool>(uniform) != nullptr && std::get<bool>(*uniform);
}

/// An error of 0 is one that the references' noise hides: it tells nothing.
std::vector<CostAndError> points_of(std::span<const Fields> rows, const std::string& error_key,
                                    bool uniform) {
  std::vector<CostAndError> points;
  for (const Fields& row : rows)
    if (is_uniform(row) == uniform && number_in(row, error_key) > 0.0)
      points.push_back({number_in(row, "cpu_ms"), number_in(row, error_key)});
  return points;
}

/// The lower hull of measured points in both logarithms: what the baseline can do for a time, as
/// generously as the points allow.
Curve best_curve(std::span<const CostAndError> points) {
  std::vector<Curve::Point> front;
  for (const std::size_t i : pareto_front(points))
    front.push_back({points[i].cost, points[i].error});
  return Curve(std::move(front));
}

/// Least error of the points that cost no more.
std::optional<double> best_within(std::span<const CostAndError> points, double cost) {
  std::optional<double> best;
  for (const CostAndError& point : points)
    if (point.cost <= cost && (!best || point.error < *best)) best = point.error;
  return best;
}

double range_end(std::span<const CostAndError> points, bool last) {
  double end = last ? 0.0 : std::numeric_limits<double>::infinity();
  for (const CostAndError& p : points) end = last ? std::max(end, p.cost) : std::min(end, p.cost);
  return end;
}

}  // namespace

double number_in(const Fields& row, const std::string& key) {
  for (const auto& [name, value] : row) {
    if (name != key) continue;
    if (const auto* real = std::get_if<double>(&value)) return *real;
    if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  }
  return kNothing;
}

std::string text_in(const Fields& row, const std::string& key) {
  for (const auto& [name, value] : row)
    if (const auto* text = std::get_if<std::string>(&value); name == key && text != nullptr)
      return *text;
  return {};
}

void set_field(Fields& row, const std::string& key, Value value) {
  for (auto& [name, old] : row)
    if (name == key) {
      old = std::move(value);
      return;
    }
  row.emplace_back(key, std::move(value));
}

std::vector<std::size_t> pareto_front(std::span<const CostAndError> points) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
    return points[a].cost != points[b].cost ? points[a].cost < points[b].cost
                                            : points[a].error < points[b].error;
  });
  std::vector<std::size_t> front;
  for (const std::size_t i : order)
    if (front.empty() || points[i].error < points[front.back()].error) front.push_back(i);
  return front;
}

void mark_fronts(std::span<Fields> rows) {
  std::vector<CostAndError> all;
  for (const Fields& row : rows) {
    // What codecs do is measured with the rows before them: they are no way to render.
    const std::string config = text_in(row, "config");
    const bool is_none = config.starts_with("jpeg=") || config.starts_with("depth=") ||
                         !(number_in(row, "rmse_ew") > 0.0);
    all.push_back({is_none ? std::numeric_limits<double>::infinity() : number_in(row, "cpu_ms"),
                   number_in(row, "rmse_ew")});
  }
  for (Fields& row : rows) set_field(row, "on_front", false);
  for (const std::size_t i : pareto_front(all))
    if (std::isfinite(all[i].cost)) set_field(rows[i], "on_front", true);
  for (const auto& [from, to] :
       {std::pair{"rmse_f10", "uniform_rmse_f10"}, std::pair{"rmse_ew", "uniform_rmse_ew"},
        std::pair{"flip_out10", "uniform_flip_out10"}}) {
    const Curve curve = best_curve(points_of(rows, from, true));
    for (Fields& row : rows)
      set_field(row, to, curve.at(number_in(row, "cpu_ms")).value_or(kNothing));
  }
}

Advantage foveated_advantage(std::span<const Fields> rows, const std::string& error_key) {
  const auto uniform = points_of(rows, error_key, true);
  const auto foveated = points_of(rows, error_key, false);
  Advantage advantage;
  if (uniform.size() < 2 || foveated.empty()) return advantage;
  const Curve curve = best_curve(uniform);
  const double low = std::max(range_end(uniform, false), range_end(foveated, false));
  const double high = std::max(range_end(uniform, true), range_end(foveated, true));
  constexpr double kSteps_per_decade = 40.0;
  const int steps = static_cast<int>(std::floor(kSteps_per_decade * std::log10(high / low)));
  advantage.of_decades = steps / kSteps_per_decade;
  advantage.least_ratio = std::numeric_limits<double>::infinity();
  double logs = 0.0;
  int below = 0, count = 0;
  for (int i = 0; i < steps; ++i) {
    const double cost = low * std::pow(10.0, i / kSteps_per_decade);
    const auto theirs = curve.at(cost), ours = best_within(foveated, cost);
    if (!theirs || !ours) continue;
    const double ratio = *theirs / *ours;
    below += ratio > 1.0 ? 1 : 0;
    logs += std::log(ratio), ++count;
    advantage.least_ratio = std::min(advantage.least_ratio, ratio);
  }
  advantage.below_decades = below / kSteps_per_decade;
  advantage.mean_ratio = count > 0 ? std::exp(logs / count) : kNothing;
  return advantage;
}

}  // namespace macula::bench
