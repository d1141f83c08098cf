#include "tests/bench/culling_equal_time.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "tests/bench/curve.h"

namespace macula::bench {
namespace {

constexpr std::array<std::string_view, 4> kRivals{"fir", "power", "flc_rays", "tree"};

double number_in(const Fields& row, const std::string& key) {
  const Value value = value_in(row, key);
  const double* number = std::get_if<double>(&value);
  return number != nullptr ? *number : NAN;
}

std::string text_in(const Fields& row, const std::string& key) {
  const Value value = value_in(row, key);
  const std::string* text = std::get_if<std::string>(&value);
  return text != nullptr ? *text : std::string();
}

bool alike(const Fields& a, const Fields& b) {
  return text_in(a, "scene") == text_in(b, "scene") && text_in(a, "motion") == text_in(b, "motion");
}

/// The rival's error at the row's time over the row's own.
std::optional<double> over(const Fields& row, const std::vector<Fields>& rows,
                           std::string_view rival, const std::string& error) {
  const double own = number_in(row, error), cpu_ms = number_in(row, "cpu_ms");
  std::vector<Curve::Point> points;
  double first_ms = INFINITY;
  for (const Fields& other : rows) {
    if (text_in(other, "method") != rival || !alike(row, other)) continue;
    const double rmse = number_in(other, error);
    points.push_back({number_in(other, "cpu_ms"), rmse * rmse});
    first_ms = std::min(first_ms, points.back().x);
  }
  if (cpu_ms < first_ms || !(own > 0.0)) return std::nullopt;
  const auto square = Curve(std::move(points)).at(cpu_ms);
  return square ? std::optional(std::sqrt(*square) / own) : std::nullopt;
}

bool same_pair(const Fields& a, const Fields& b) {
  return text_in(a, "method") == text_in(b, "method") &&
         text_in(a, "rival") == text_in(b, "rival") &&
         value_in(a, "asked_for") == value_in(b, "asked_for");
}

/// Over the rows of one method and rival, a row for each pair that has several.
std::vector<Fields> means_of(const std::vector<Fields>& told) {
  std::vector<Fields> means;
  for (const Fields& first : told) {
    const auto of_pair = [&](const Fields& other) { return same_pair(first, other); };
    if (std::ranges::any_of(means, of_pair)) continue;
    const auto count = static_cast<double>(std::ranges::count_if(told, of_pair));
    if (count < 2.0) continue;
    double inside = 0.0, outside = 0.0;
    for (const Fields& other : told) {
      if (!of_pair(other)) continue;
      inside += std::log(number_in(other, "over_in150")) / count;
      outside += std::log(number_in(other, "over_out150")) / count;
    }
    means.push_back({{"scene", std::string("(mean)")},
                     {"motion", std::string("")},
                     {"method", text_in(first, "method")},
                     {"asked_for", value_in(first, "asked_for")},
                     {"rival", text_in(first, "rival")},
                     {"over_in150", std::exp(inside)},
                     {"over_out150", std::exp(outside)}});
  }
  return means;
}

}  // namespace

bool is_rival(std::string_view method) {
  return std::ranges::find(kRivals, method) != kRivals.end();
}

std::vector<Fields> errors_at_equal_time(const std::vector<Fields>& rows) {
  std::vector<Fields> told;
  for (const Fields& row : rows) {
    const std::string method = text_in(row, "method");
    if (!method.starts_with("flc")) continue;
    for (const std::string_view rival : kRivals) {
      if (rival == method) continue;
      const auto inside = over(row, rows, rival, "rmse_in150");
      const auto outside = over(row, rows, rival, "rmse_out150");
      if (!inside || !outside) continue;
      told.push_back({{"scene", text_in(row, "scene")},
                      {"motion", text_in(row, "motion")},
                      {"method", method},
                      {"asked_for", value_in(row, "asked_for")},
                      {"rival", std::string(rival)},
                      {"over_in150", *inside},
                      {"over_out150", *outside}});
    }
  }
  const std::vector<Fields> means = means_of(told);
  told.insert(told.end(), means.begin(), means.end());
  return told;
}

}  // namespace macula::bench
