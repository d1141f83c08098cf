// What rows of `macula-bench tradeoff` mean beside each other: which no other beats, and what a
// whole picture shows for the same time. Rows are of one kernel and scene. Pure.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tests/bench/report.h"

namespace macula::bench {

/// A number of a row; NaN where it has none.
double number_in(const Fields& row, const std::string& key);
std::string text_in(const Fields& row, const std::string& key);
void set_field(Fields& row, const std::string& key, Value value);

/// Indices of points that no other beats in both, by rising x.
struct CostAndError {
  double cost = 0.0, error = 0.0;
};
std::vector<std::size_t> pareto_front(std::span<const CostAndError> points);

/// Sets on_front (cpu_ms and rmse_ew) and the columns uniform_* of every row.
void mark_fronts(std::span<Fields> rows);

/// Over how many decades of time the best foveated row is better than the best whole picture for
/// the same time: between the cheapest and the dearest time at which both exist.
struct Advantage {
  double below_decades = 0.0, of_decades = 0.0;
  double least_ratio = 0.0;  ///< uniform over foveated error where it is worst
  double mean_ratio = 0.0;   ///< geometric, over the logarithm of time
};
Advantage foveated_advantage(std::span<const Fields> rows, const std::string& error_key);

}  // namespace macula::bench
