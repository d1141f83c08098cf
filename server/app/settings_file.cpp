#include "server/app/settings_file.h"

#include <array>
#include <exception>
#include <sstream>
#include <string_view>
#include <toml.hpp>

#include "server/app/toml_text.h"
#include "shared/base/text.h"

namespace macula::server_app {
namespace {

/// What is wrong with a value, or an empty text.
using Problem = std::string;

Problem set(std::string& target, const toml::value& value) {
  if (!value.is_string()) return "must be a text in quotes";
  target = value.as_string().str;
  return {};
}
Problem set(double& target, const toml::value& value) {
  if (value.is_integer())
    target = static_cast<double>(value.as_integer());
  else if (value.is_floating())
    target = value.as_floating();
  else
    return "must be a number";
  return {};
}
Problem set(std::optional<double>& target, const toml::value& value) {
  double number = 0.0;
  Problem problem = set(number, value);
  if (problem.empty()) target = number;
  return problem;
}
Problem set(int& target, const toml::value& value) {
  constexpr std::int64_t kMost = 1'000'000;
  if (!value.is_integer() || value.as_integer() < 0 || value.as_integer() > kMost)
    return "must be a whole number from 0";
  target = static_cast<int>(value.as_integer());
  return {};
}
Problem set(bool& target, const toml::value& value) {
  if (!value.is_boolean()) return "must be true or false";
  target = value.as_boolean();
  return {};
}

struct Key {
  std::string_view name;
  Problem (*apply)(Options& options, const toml::value& value);
};

template <auto Member>
Problem apply(Options& options, const toml::value& value) {
  return set(options.*Member, value);
}

constexpr std::array kKeys{
    Key{"scene", apply<&Options::scene>},
    Key{"kernel", apply<&Options::kernel>},
    Key{"bind", apply<&Options::bind>},
    Key{"keys", apply<&Options::keys>},
    Key{"target_ms", apply<&Options::target_ms>},
    Key{"rate_model", apply<&Options::rate_model>},
    Key{"oversampling", apply<&Options::oversampling>},
    Key{"guard_deg", apply<&Options::guard_deg>},
    Key{"predict_ms", apply<&Options::predict_ms>},
    Key{"view_cell_cm", apply<&Options::view_cell_cm>},
    Key{"age_ms", apply<&Options::age_ms>},
    Key{"quality", apply<&Options::quality>},
    Key{"color_quality", apply<&Options::color_quality>},
    Key{"max_error", apply<&Options::max_error>},
    Key{"ladders", apply<&Options::ladders>},
    Key{"codec", apply<&Options::codec>},
    Key{"area_samples", apply<&Options::area_samples>},
    Key{"ambient_samples", apply<&Options::ambient_samples>},
    Key{"knobs", apply<&Options::knobs>},
    Key{"threads", apply<&Options::threads>},
    Key{"balance", apply<&Options::balance>},
    Key{"rank_timeout_ms", apply<&Options::rank_timeout_ms>},
    Key{"reuse", apply<&Options::reuse>},
    Key{"perceived_lights", apply<&Options::perceived_lights>},
    Key{"bounced_rays", apply<&Options::bounced_rays>},
    Key{"metrics", apply<&Options::metrics>},
    Key{"verbose", apply<&Options::verbose>},
};

std::string known_keys() {
  std::string names;
  for (const Key& key : kKeys) names += (names.empty() ? "" : ", ") + std::string(key.name);
  return names;
}

Result<void> apply_entry(const std::string& path, const std::string& name, const toml::value& value,
                         Options& options) {
  const std::string where = base::concat(path, ":", value.location().line());
  for (const Key& key : kKeys) {
    if (key.name != name) continue;
    const Problem problem = key.apply(options, value);
    if (problem.empty()) return {};
    return base::bad_input(base::concat("'", name, "' ", problem), where);
  }
  return base::bad_input(base::concat("unknown key '", name, "'"), where, "known: " + known_keys());
}

}  // namespace

std::vector<std::string> settings_keys() {
  std::vector<std::string> names;
  for (const Key& key : kKeys) names.emplace_back(key.name);
  return names;
}

Result<void> apply_settings_file(const std::string& path, Options& options) {
  auto text = read_toml_text(path);
  if (!text) return base::forward(text);
  try {
    std::istringstream stream(std::move(*text));
    const toml::value root = toml::parse(stream, path);
    for (const auto& [name, value] : root.as_table())
      if (auto applied = apply_entry(path, name, value, options); !applied) return applied;
  } catch (const toml::syntax_error& error) {
    return base::bad_input(first_line(error.what()),
                           base::concat(path, ":", error.location().line()), "TOML is expected");
  } catch (const std::exception& error) {
    return base::bad_input(first_line(error.what()), path);
  }
  return {};
}

}  // namespace macula::server_app
