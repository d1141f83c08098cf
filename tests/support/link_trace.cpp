#include "tests/support/link_trace.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "shared/base/text.h"

namespace macula::support {
namespace {

using std::chrono::nanoseconds;

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream text(line);
  for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
  return cells;
}

nanoseconds from_s(double seconds) {
  return nanoseconds{std::llround(1e9 * seconds)};
}

/// Where a recording's columns stand.
struct Columns {
  std::size_t time = 0, value = 0;
  bool is_delay = false;

  LinkShape shape(LinkShape shape, double value_read) const {
    constexpr double kLeastBytesPerS = 1000.0;  // 0 would mean no limit
    if (is_delay) {
      shape.delay = from_s(0.5e-3 * value_read);
    } else {
      shape.bytes_per_s = std::max(value_read * 1e6 / 8.0, kLeastBytesPerS);
    }
    return shape;
  }
};

Result<Columns> find_columns(const std::string& header, const std::string& path) {
  const std::vector<std::string> names = cells_of(header);
  const auto place = [&](const char* name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  const std::size_t time = place("t_s"), rtt = place("rtt_ms"), capacity = place("capacity_mbps");
  const std::size_t value = std::min(rtt, capacity);
  if (time < names.size() && value < names.size()) return Columns{time, value, value == rtt};
  return base::bad_input("not a recorded link", path + ":1",
                         "columns t_s and rtt_ms or capacity_mbps");
}

}  // namespace

Result<LinkTrace> load_link_trace(const std::string& path, const LinkShape& base) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) return base::bad_input("cannot be read", path, "a CSV file");
  const auto columns = find_columns(line, path);
  if (!columns) return base::forward(columns);
  LinkTrace trace;
  for (int number = 2; std::getline(file, line); ++number) {
    const std::vector<std::string> cells = cells_of(line);
    const std::size_t needed = std::max(columns->time, columns->value);
    char* end = nullptr;
    const double at =
        cells.size() > needed ? std::strtod(cells[columns->time].c_str(), &end) : -1.0;
    if (!(at >= 0.0) || (!trace.steps.empty() && from_s(at) < trace.steps.back().at)) {
      return base::bad_input("not a later time", base::concat(path, ":", number));
    }
    const double value = std::strtod(cells[columns->value].c_str(), &end);
    trace.steps.push_back({from_s(at), columns->shape(base, value)});
  }
  if (trace.steps.empty()) return base::bad_input("no samples", path);
  const auto count = static_cast<std::int64_t>(trace.steps.size());
  trace.lasts =
      trace.steps.back().at + std::max(trace.steps.back().at / count, nanoseconds{1'000'000});
  return trace;
}

}  // namespace macula::support
