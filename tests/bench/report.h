// What every experiment leaves behind: one table on stdout and, when asked, one JSON file
//   {"experiment","machine":{},"commit","command","config":{},"rows":[{...}]}
// Plain numbers with the unit in the key (_ms _px _db _bytes). Not thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "shared/base/result.h"

namespace macula::bench {

/// A non-finite double is printed as it is and becomes null in JSON.
using Value = std::variant<double, std::int64_t, bool, std::string>;
/// Keys in the order they are to be read.
using Fields = std::vector<std::pair<std::string, Value>>;

struct Report {
  std::string experiment;
  Fields config;             ///< the effective options
  std::vector<Fields> rows;  ///< all with the same keys in the same order
};

/// Adds the machine (cpu, cores, isa), the commit the program was configured at and how it was
/// called. Overwrites.
Result<void> write_json(const std::string& path, const Report& report);
/// The rows of an earlier report with the same experiment and config, so that a run can go on where
/// it ended; none where there is no such file. Another experiment or config is an error.
Result<std::vector<Fields>> read_rows(const std::string& path, const Report& like);
/// One that was written before, whatever it was of.
struct LoadedReport : Report {
  Fields machine;
  std::string commit, command;  ///< as it was called, empty where that was not kept
};
/// Errors: no such file, or no report.
Result<LoadedReport> read_report(const std::string& path);

std::string value_text(const Value& value);
/// The value of a row's key; an empty text where it has none.
Value value_in(const Fields& row, const std::string& key);
/// As JSON: an array of objects; a text in quotes.
std::string rows_json(const std::vector<Fields>& rows);
std::string quoted_json(const std::string& text);

/// The rows under one header line, columns aligned.
std::string table_text(const std::vector<Fields>& rows);

}  // namespace macula::bench
