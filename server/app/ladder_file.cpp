#include "server/app/ladder_file.h"

#include <exception>
#include <sstream>
#include <toml.hpp>

#include "server/app/toml_text.h"
#include "shared/base/text.h"

namespace macula::server_app {
namespace {

std::string place(const std::string& path, const toml::value& value) {
  return base::concat(path, ":", value.location().line());
}

Result<double> number(const std::string& path, const toml::value& step, const char* key) {
  if (!step.is_table() || !step.contains(key))
    return base::bad_input(base::concat("a step has no '", key, "'"), place(path, step),
                           "quality, scale, knobs, cost and rmse");
  const toml::value& value = step.at(key);
  if (value.is_floating()) return value.as_floating();
  if (value.is_integer()) return static_cast<double>(value.as_integer());
  return base::bad_input(base::concat("'", key, "' must be a number"), place(path, value));
}

Result<session::QualityStep> step_of(const std::string& path, const toml::value& table) {
  session::QualityStep step;
  for (const auto& [key, into] :
       {std::pair{"quality", &step.quality}, std::pair{"scale", &step.scale},
        std::pair{"cost", &step.cost}, std::pair{"rmse", &step.rmse}}) {
    const auto value = number(path, table, key);
    if (!value) return base::forward(value);
    *into = *value;
  }
  if (!table.contains("knobs") || !table.at("knobs").is_string())
    return base::bad_input("a step has no 'knobs'", place(path, table), "a text, \"\" for none");
  auto knobs = kernels::parse_knobs(table.at("knobs").as_string().str);
  if (!knobs) return base::forward(knobs);
  step.knobs = std::move(*knobs);
  return step;
}

Result<LadderFile> ladder_of(const std::string& path, const toml::value& root) {
  if (!root.contains("kernel") || !root.at("kernel").is_string() || !root.contains("step") ||
      !root.at("step").is_array())
    return base::bad_input("is no quality ladder", path, "kernel = \"NAME\" and [[step]] tables");
  std::vector<session::QualityStep> steps;
  for (const toml::value& table : root.at("step").as_array()) {
    auto step = step_of(path, table);
    if (!step) return base::forward(step);
    steps.push_back(std::move(*step));
  }
  auto ladder = session::QualityLadder::create(std::move(steps));
  if (!ladder) return base::bad_input(ladder.error().what, path, ladder.error().remedy);
  return LadderFile{root.at("kernel").as_string().str, std::move(*ladder)};
}

}  // namespace

Result<LadderFile> load_ladder_file(const std::string& path) {
  auto text = read_toml_text(path);
  if (!text) return base::forward(text);
  try {
    std::istringstream stream(std::move(*text));
    return ladder_of(path, toml::parse(stream, path));
  } catch (const toml::syntax_error& error) {
    return base::bad_input(first_line(error.what()),
                           base::concat(path, ":", error.location().line()), "TOML is expected");
  } catch (const std::exception& error) {
    return base::bad_input(first_line(error.what()), path);
  }
}

}  // namespace macula::server_app
