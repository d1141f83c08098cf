#include "client/pose/trace.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "shared/base/text.h"

namespace macula::pose {
namespace {

constexpr std::size_t kColumnCount = 11;
constexpr std::array<std::string_view, kColumnCount> kColumnNames = {
    "t_s", "px", "py", "pz", "qx", "qy", "qz", "qw", "gx", "gy", "gz"};
constexpr std::size_t kFirstGazeColumn = 8;
constexpr double kUnitTolerance = 0.01;
/// Ten years: anything longer is a wrong unit, and still fits nanoseconds in 64 bits.
constexpr double kLatest_s = 3.2e8;
constexpr std::uintmax_t kLargestFile = 256U << 20;

using Fields = std::vector<std::string_view>;
using Numbers = std::array<std::optional<double>, kColumnCount>;

/// Where a complaint points to.
struct Place {
  const std::string& file;
  std::size_t line;
  std::string text() const { return base::concat(file, ":", line); }
  std::string text(std::size_t column) const {
    return base::concat(text(), ", column ", column + 1, " (", kColumnNames[column], ")");
  }
};

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const auto begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

Fields split(std::string_view line) {
  Fields fields;
  for (;;) {
    const auto comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

Result<void> check_header(std::string_view line, const Place& place) {
  const Fields fields = split(line);
  const std::string remedy = base::concat("the first line must read ", kTraceColumns);
  for (std::size_t i = 0; i < kColumnCount; ++i) {
    if (std::find(fields.begin(), fields.end(), kColumnNames[i]) == fields.end()) {
      return base::bad_input(base::concat("column '", kColumnNames[i], "' is missing"),
                             place.text(), remedy);
    }
  }
  if (!std::equal(fields.begin(), fields.end(), kColumnNames.begin(), kColumnNames.end())) {
    return base::bad_input("the columns are not in the order expected", place.text(), remedy);
  }
  return {};
}

Result<std::optional<double>> parse_field(std::string_view field, std::size_t column,
                                          const Place& place) {
  if (field.empty() && column >= kFirstGazeColumn) return std::optional<double>{};
  double value = 0.0;
  const auto [end, code] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (code != std::errc{} || end != field.data() + field.size() || !std::isfinite(value)) {
    return base::bad_input(base::concat("'", field, "' is not a finite number"), place.text(column),
                           column >= kFirstGazeColumn ? "a decimal number, or nothing: no gaze"
                                                      : "a decimal number such as -0.25");
  }
  return std::optional<double>{value};
}

Result<Numbers> parse_numbers(std::string_view line, const Place& place) {
  const Fields fields = split(line);
  if (fields.size() != kColumnCount) {
    return base::bad_input(base::concat(fields.size(), " columns instead of ", kColumnCount),
                           place.text(), base::concat("every line holds ", kTraceColumns));
  }
  Numbers numbers;
  for (std::size_t i = 0; i < kColumnCount; ++i) {
    auto number = parse_field(fields[i], i, place);
    if (!number) return base::forward(number);
    numbers[i] = *number;
  }
  return numbers;
}

Result<Pose> make_pose(const Numbers& n, const Place& place) {
  Pose pose{{*n[1], *n[2], *n[3]}, DQuat{*n[7], *n[4], *n[5], *n[6]}};
  const double length = glm::length(pose.rotation);
  if (!(std::abs(length - 1.0) <= kUnitTolerance)) {
    return base::bad_input(base::concat("quaternion qx,qy,qz,qw has length ", length),
                           place.text(4), "length 1 within 1 %");
  }
  pose.rotation = glm::normalize(pose.rotation);
  if (!math::is_valid(pose)) {
    return base::bad_input("head position is too far away", place.text(1),
                           "meters, nearer than 1e7 m");
  }
  return pose;
}

Result<std::optional<Vec3>> make_gaze(const Numbers& n, const Place& place) {
  const auto given = std::count_if(n.begin() + kFirstGazeColumn, n.end(),
                                   [](const auto& number) { return number.has_value(); });
  if (given == 0) return std::optional<Vec3>{};
  if (given != 3) {
    return base::bad_input("gaze gx,gy,gz is given in part", place.text(kFirstGazeColumn),
                           "all three numbers, or none of them");
  }
  const DVec3 gaze{*n[8], *n[9], *n[10]};
  const double length = glm::length(gaze);
  if (!(std::abs(length - 1.0) <= kUnitTolerance)) {
    return base::bad_input(base::concat("gaze gx,gy,gz has length ", length),
                           place.text(kFirstGazeColumn), "length 1 within 1 %");
  }
  return std::optional<Vec3>{Vec3(gaze / length)};
}

Result<TraceSample> parse_sample(std::string_view line, const Place& place) {
  const auto numbers = parse_numbers(line, place);
  if (!numbers) return base::forward(numbers);
  const double at_s = *(*numbers)[0];
  if (!(std::abs(at_s) <= kLatest_s)) {
    return base::bad_input(base::concat("time ", at_s, " s is out of range"), place.text(0),
                           "seconds from the start of the recording");
  }
  const auto pose = make_pose(*numbers, place);
  if (!pose) return base::forward(pose);
  const auto gaze = make_gaze(*numbers, place);
  if (!gaze) return base::forward(gaze);
  return TraceSample{units::from_s(at_s), *pose, *gaze};
}

Result<void> append(Trace& trace, const TraceSample& sample, const Place& place) {
  if (!trace.samples.empty() && sample.at <= trace.samples.back().at) {
    return base::bad_input(
        base::concat("time ", units::to_s(sample.at), " s does not increase (the line before has ",
                     units::to_s(trace.samples.back().at), " s)"),
        place.text(0), "t_s rises from line to line");
  }
  trace.samples.push_back(sample);
  return {};
}

std::optional<Vec3> mix_gaze(const TraceSample& a, const TraceSample& b, double t) {
  const auto& nearer = t < 0.5 ? a.gaze : b.gaze;
  if (!a.gaze || !b.gaze) return nearer;
  const Vec3 mixed = *a.gaze + static_cast<float>(t) * (*b.gaze - *a.gaze);
  // Opposite gazes pass through the origin, where there is no direction.
  constexpr float kShortest = 1e-3F;
  return glm::length(mixed) > kShortest ? glm::normalize(mixed) : *nearer;
}

HeadSample make_head(const Pose& pose, const std::optional<Vec3>& gaze) {
  HeadSample head;
  head.stage_from_head = pose;
  head.gaze = gaze ? Gaze{*gaze, true, 1.0F} : Gaze{Vec3(0.0F, 0.0F, -1.0F), false, 0.0F};
  return head;
}

}  // namespace

HeadSample Trace::at(Nanoseconds since_start) const {
  const Nanoseconds t = samples.front().at + since_start;
  const auto after = std::upper_bound(samples.begin(), samples.end(), t,
                                      [](Nanoseconds at, const auto& s) { return at < s.at; });
  if (after == samples.begin()) return make_head(after->stage_from_head, after->gaze);
  const TraceSample& a = *(after - 1);
  if (after == samples.end()) return make_head(a.stage_from_head, a.gaze);
  const double share = units::to_s(t - a.at) / units::to_s(after->at - a.at);
  return make_head(math::interpolate(a.stage_from_head, after->stage_from_head, share),
                   mix_gaze(a, *after, share));
}

Result<Trace> parse_trace(std::string_view text, const std::string& name) {
  Trace trace;
  std::size_t line_number = 0;
  bool header_seen = false;
  while (!text.empty()) {
    const auto end = text.find('\n');
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    const Place place{name, ++line_number};
    if (line.empty() && header_seen) continue;
    if (!header_seen) {
      if (const auto header = check_header(line, place); !header) return base::forward(header);
      header_seen = true;
      continue;
    }
    const auto sample = parse_sample(line, place);
    if (!sample) return base::forward(sample);
    if (const auto added = append(trace, *sample, place); !added) return base::forward(added);
  }
  if (trace.samples.size() < 2) {
    return base::bad_input(base::concat("a trace of ", trace.samples.size(), " samples"), name,
                           base::concat("a line ", kTraceColumns, " and two samples or more"));
  }
  return trace;
}

Result<Trace> load_trace(const std::string& path) {
  std::error_code code;
  const auto size = std::filesystem::file_size(path, code);
  if (code) {
    return base::bad_input(base::concat("cannot be read: ", code.message()), path,
                           base::concat("a CSV file with the columns ", kTraceColumns));
  }
  if (size > kLargestFile) return base::bad_input("is larger than 256 MiB", path, "cut the trace");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) return base::bad_input("cannot be read", path, "a readable CSV file");
  return parse_trace(std::move(text).str(), path);
}

std::string to_csv(const Trace& trace) {
  std::string csv = base::concat(kTraceColumns, "\n");
  for (const TraceSample& sample : trace.samples) csv += to_csv_line(sample);
  return csv;
}

std::string to_csv_line(const TraceSample& sample) {
  const DVec3& p = sample.stage_from_head.position;
  const DQuat& q = sample.stage_from_head.rotation;
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), "%.4f,%.5f,%.5f,%.5f,%.6f,%.6f,%.6f,%.6f,",
                units::to_s(sample.at), p.x, p.y, p.z, q.x, q.y, q.z, q.w);
  std::string line = text.data();
  if (!sample.gaze) return line + ",,\n";
  const DVec3 gaze(*sample.gaze);
  std::snprintf(text.data(), text.size(), "%.6f,%.6f,%.6f\n", gaze.x, gaze.y, gaze.z);
  return line + text.data();
}

}  // namespace macula::pose
