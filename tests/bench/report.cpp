#include "tests/bench/report.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>
#include <thread>

#include <nlohmann/json.hpp>

#include "shared/base/text.h"

namespace macula::bench {
namespace {

using Json = nlohmann::ordered_json;

/// From the system's own description; empty where there is none.
std::string cpu_model() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t colon = line.find(": ");
    return colon == std::string::npos ? std::string{} : line.substr(colon + 2);
  }
  return {};
}

/// How this program was called, a word in quotes where it has blanks; empty where nobody can tell.
std::string command_line() {
  std::ifstream in("/proc/self/cmdline", std::ios::binary);
  std::string line;
  for (std::string word; std::getline(in, word, '\0');) {
    if (line.empty()) word = word.substr(word.rfind('/') + 1);
    const bool plain = !word.empty() && word.find_first_of(" \"'$;&|<>*?()") == std::string::npos;
    if (!line.empty()) line += ' ';
    line += plain ? word : base::concat('"', word, '"');
  }
  return line;
}

const char* widest_isa() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f")) return "avx512";
  if (__builtin_cpu_supports("avx2")) return "avx2";
  return "sse4.2";
}

Json json_of(const Fields& fields) {
  Json object = Json::object();
  for (const auto& [key, value] : fields) {
    std::visit([&object, &name = key](const auto& plain) { object[name] = plain; }, value);
  }
  return object;
}

Json json_of(const Report& report) {
  Json rows = Json::array();
  for (const Fields& row : report.rows) rows.push_back(json_of(row));
  return Json{{"experiment", report.experiment},
              {"machine",
               {{"cpu", cpu_model()},
                {"cores", std::thread::hardware_concurrency()},
                {"isa", widest_isa()}}},
              {"commit", MACULA_COMMIT},
              {"command", command_line()},
              {"config", json_of(report.config)},
              {"rows", std::move(rows)}};
}

Value value_of(const Json& json) {
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (json.is_number()) return json.get<double>();
  if (json.is_string()) return json.get<std::string>();
  return std::numeric_limits<double>::quiet_NaN();
}

Fields fields_of(const Json& object) {
  Fields fields;
  if (!object.is_object()) return fields;
  for (const auto& [key, value] : object.items()) fields.emplace_back(key, value_of(value));
  return fields;
}

/// Columns wide enough for all lines, right-aligned, two spaces apart.
std::string aligned(const std::vector<std::vector<std::string>>& lines) {
  std::vector<std::size_t> widths;
  for (const auto& line : lines) {
    widths.resize(std::max(widths.size(), line.size()), 0);
    for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], line[i].size());
  }
  std::string text;
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      text += std::string(widths[i] - line[i].size() + (i == 0 ? 0 : 2), ' ') + line[i];
    }
    text += '\n';
  }
  return text;
}

}  // namespace

Result<void> write_json(const std::string& path, const Report& report) {
  std::string text;
  try {
    text = json_of(report).dump(2) + "\n";
  } catch (const nlohmann::json::exception& error) {
    return base::bad_input(std::string("a value is not UTF-8 text: ") + error.what(), path,
                           "rename the file or option that carries it");
  }
  errno = 0;
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out << text;
  out.close();
  if (!out) {
    return base::bad_input(std::string("cannot be written: ") + std::strerror(errno), path,
                           "give a path in a folder that exists and has room");
  }
  return {};
}

Result<std::vector<Fields>> read_rows(const std::string& path, const Report& like) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return std::vector<Fields>{};
  const Json known = Json::parse(in, nullptr, false);
  if (!known.is_object() || !known.contains("rows") || !known["rows"].is_array()) {
    return base::bad_input("is no report", path, "delete it or name another file");
  }
  if (known.value("experiment", "") != like.experiment ||
      known.value("config", Json::object()) != json_of(like.config)) {
    return base::bad_input("was measured with other settings", path,
                           "delete it or name another file");
  }
  std::vector<Fields> rows;
  for (const Json& row : known["rows"]) rows.push_back(fields_of(row));
  return rows;
}

Result<LoadedReport> read_report(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return base::bad_input("cannot be read", path, "a report of macula-bench");
  const Json json = Json::parse(in, nullptr, false);
  if (!json.is_object() || !json.contains("experiment") || !json["experiment"].is_string() ||
      !json.contains("rows") || !json["rows"].is_array())
    return base::bad_input("is no report", path, "a JSON file that macula-bench wrote");
  const auto text = [&](const char* key) {
    return json.contains(key) && json[key].is_string() ? json[key].get<std::string>()
                                                       : std::string{};
  };
  LoadedReport report;
  report.experiment = text("experiment");
  report.commit = text("commit"), report.command = text("command");
  report.config = fields_of(json.value("config", Json::object()));
  report.machine = fields_of(json.value("machine", Json::object()));
  for (const Json& row : json["rows"]) report.rows.push_back(fields_of(row));
  return report;
}

std::string value_text(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* yes = std::get_if<bool>(&value)) return *yes ? "yes" : "no";
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return std::to_string(*whole);
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", std::get<double>(value));
  return buffer;
}

Value value_in(const Fields& row, const std::string& key) {
  for (const auto& [name, value] : row)
    if (name == key) return value;
  return std::string{};
}

std::string rows_json(const std::vector<Fields>& rows) {
  Json array = Json::array();
  for (const Fields& row : rows) array.push_back(json_of(row));
  return array.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string quoted_json(const std::string& text) {
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string table_text(const std::vector<Fields>& rows) {
  if (rows.empty()) return {};
  std::vector<std::vector<std::string>> lines(1);
  for (const auto& [key, value] : rows.front()) lines[0].push_back(key);
  for (const Fields& row : rows) {
    lines.emplace_back();
    for (const auto& [key, value] : row) lines.back().push_back(value_text(value));
  }
  return aligned(lines);
}

}  // namespace macula::bench
