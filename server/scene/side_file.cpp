#include "server/scene/side_file.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <initializer_list>
#include <sstream>
#include <string_view>
#include <toml.hpp>

#include "server/scene/files.h"
#include "server/scene/json_guard.h"
#include "shared/base/text.h"
#include "shared/base/utf8.h"

namespace macula::scene {
namespace {

constexpr std::uint64_t kMaxBytes = 1 << 16;
/// The parser recurses; honest side files nest two levels.
constexpr std::size_t kMaxDepth = 16;

/// Reads one table key by key, remembers the first thing that is wrong, and in the end refuses keys
/// nobody asked for.
class TableReader {
 public:
  TableReader(const toml::value& table, std::string file) : table_(table), file_(std::move(file)) {}

  std::optional<double> number(const char* key, double low, double high) {
    const toml::value* value = find(key);
    if (!value) return std::nullopt;
    const std::optional<double> read = as_number(*value);
    if (!read || !(*read >= low && *read <= high)) {
      fail(*value, base::concat(key, " must be a number in [", low, ", ", high, "]"));
      return std::nullopt;
    }
    return read;
  }

  std::optional<std::vector<double>> numbers(const char* key, std::size_t count, double low,
                                             double high) {
    const toml::value* value = find(key);
    if (!value) return std::nullopt;
    std::vector<double> result;
    if (value->is_array()) {
      for (const toml::value& element : value->as_array()) {
        const std::optional<double> read = as_number(element);
        if (read && *read >= low && *read <= high) result.push_back(*read);
      }
    }
    if (result.size() != count || value->as_array().size() != count) {
      fail(*value, base::concat(key, " must be ", count, " numbers in [", low, ", ", high, "]"));
      return std::nullopt;
    }
    return result;
  }

  std::optional<DVec3> vector(const char* key, double low, double high) {
    const auto values = numbers(key, 3, low, high);
    if (!values) return std::nullopt;
    return DVec3{(*values)[0], (*values)[1], (*values)[2]};
  }

  std::optional<std::string> one_of(const char* key,
                                    std::initializer_list<std::string_view> allowed) {
    const toml::value* value = find(key);
    if (!value) return std::nullopt;
    const bool known = value->is_string() && std::find(allowed.begin(), allowed.end(),
                                                       value->as_string().str) != allowed.end();
    if (!known) {
      std::string list;
      for (const std::string_view word : allowed)
        list += (list.empty() ? "" : ", ") + std::string(word);
      fail(*value, base::concat(key, " must be one of ", list));
      return std::nullopt;
    }
    return value->as_string().str;
  }

  /// A string here, numbers elsewhere: whether `key` is text.
  std::optional<std::string> text(const char* key) {
    const toml::value* value = find(key);
    if (!value || !value->is_string()) return std::nullopt;
    return value->as_string().str;
  }

  std::optional<TableReader> table(const char* key) {
    const toml::value* value = find(key);
    if (!value) return std::nullopt;
    if (!value->is_table()) {
      fail(*value, base::concat(key, " must be a table"));
      return std::nullopt;
    }
    return TableReader(*value, file_);
  }

  std::vector<TableReader> tables(const char* key) {
    const toml::value* value = find(key);
    std::vector<TableReader> result;
    if (!value) return result;
    if (!value->is_array()) {
      fail(*value, base::concat(key, " must be tables, each under [[", key, "]]"));
      return result;
    }
    for (const toml::value& element : value->as_array()) {
      if (element.is_table()) result.emplace_back(element, file_);
      if (!element.is_table())
        fail(element, base::concat(key, " must be tables, each under [[", key, "]]"));
    }
    return result;
  }

  void refuse(std::string what) { fail(table_, std::move(what)); }

  /// The first error, or one for a key that nobody read.
  Result<void> finish() {
    for (const auto& [key, value] : table_.as_table()) {
      if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
        std::string list;
        for (const std::string& word : known_) list += (list.empty() ? "" : ", ") + word;
        fail(value, "unknown key '" + key + "'", "allowed: " + list);
      }
    }
    if (error_) return tl::unexpected(*error_);
    return {};
  }

 private:
  const toml::value* find(const char* key) {
    known_.emplace_back(key);
    const auto& entries = table_.as_table();
    const auto found = entries.find(key);
    return found == entries.end() ? nullptr : &found->second;
  }
  static std::optional<double> as_number(const toml::value& value) {
    if (value.is_floating()) return value.as_floating();
    if (value.is_integer()) return static_cast<double>(value.as_integer());
    return std::nullopt;
  }
  void fail(const toml::value& value, std::string what,
            std::string remedy = "correct or remove it") {
    if (error_) return;
    error_ = Error{std::move(what), base::concat(file_, ": line ", value.location().line()),
                   std::move(remedy)};
  }

  const toml::value& table_;
  std::string file_;
  std::vector<std::string> known_;
  std::optional<Error> error_;
};

constexpr double kFarthest = 1e6;    // m
constexpr double kBrightest = 1e12;  // W/sr and the like

Result<Pose> read_pose(TableReader& table) {
  Pose pose;
  pose.position = table.vector("position_m", -kFarthest, kFarthest).value_or(DVec3{0.0});
  const auto yaw = table.number("yaw_deg", -360.0, 360.0);
  const auto rotation = table.numbers("rotation", 4, -1.0, 1.0);
  if (yaw && rotation) table.refuse("yaw_deg and rotation exclude each other");
  if (yaw) pose.rotation = glm::angleAxis(Radians(Degrees{*yaw}).value(), DVec3{0.0, 1.0, 0.0});
  if (rotation) {
    const DQuat given((*rotation)[3], (*rotation)[0], (*rotation)[1], (*rotation)[2]);
    if (std::abs(glm::length(given) - 1.0) > 1e-2)
      table.refuse("rotation must be a unit quaternion x, y, z, w");
    pose.rotation = normalize(given);
  }
  return table.finish().map([&pose] { return pose; });
}

Result<Light> read_light(TableReader& table) {
  Light light;
  const std::string kind = table.one_of("kind", {"point", "spot", "directional"}).value_or("point");
  if (kind == "spot") light.kind = LightKind::Spot;
  if (kind == "directional") light.kind = LightKind::Directional;
  light.position = table.vector("position_m", -kFarthest, kFarthest).value_or(DVec3{0.0});
  light.intensity = Rgb(table.vector("intensity", 0.0, kBrightest).value_or(DVec3{1.0}));
  const DVec3 direction =
      table.vector("direction", -kFarthest, kFarthest).value_or(DVec3{0.0, -1.0, 0.0});
  if (!(glm::length(direction) > 0.0)) table.refuse("direction must not be zero");
  light.direction = Vec3(normalize(direction));
  light.inner_cone = Degrees{table.number("inner_cone_deg", 0.0, 90.0).value_or(0.0)};
  light.outer_cone = Degrees{table.number("outer_cone_deg", 0.0, 90.0).value_or(45.0)};
  if (!(light.inner_cone < light.outer_cone))
    table.refuse("inner_cone_deg must be below outer_cone_deg");
  return table.finish().map([&light] { return light; });
}

Result<SideFile> interpret(const toml::value& root, const std::string& file) {
  SideFile side;
  TableReader table(root, file);
  side.meters_per_unit = table.number("meters_per_unit", 1e-9, 1e9);
  if (const auto ev = table.number("exposure_ev", -30.0, 30.0))
    side.exposure_ev = static_cast<float>(*ev);
  if (const auto curve = table.one_of("tone_curve", {"linear", "filmic"})) {
    side.tone_curve = *curve == "filmic" ? image::ToneCurve::Filmic : image::ToneCurve::Linear;
  }
  if (const auto ambient = table.vector("ambient", 0.0, kBrightest)) side.ambient = Rgb(*ambient);
  side.ambient_distance_m =
      table.number("ambient_distance_m", 1e-3, std::numeric_limits<double>::infinity());
  side.environment_file = table.text("environment");
  if (!side.environment_file) {
    if (const auto color = table.vector("environment", 0.0, kBrightest)) {
      side.environment_color = Rgb(*color);
    }
  }
  side.environment_yaw_deg = table.number("environment_yaw_deg", -360.0, 360.0).value_or(0.0);
  side.environment_scale = table.number("environment_scale", 0.0, kBrightest).value_or(1.0);
  if (auto stage = table.table("scene_from_stage")) {
    const Result<Pose> pose = read_pose(*stage);
    if (!pose) return forward(pose);
    side.scene_from_stage = *pose;
  }
  for (TableReader& entry : table.tables("light")) {
    const Result<Light> light = read_light(entry);
    if (!light) return forward(light);
    side.lights.push_back(*light);
  }
  return table.finish().map([&side] { return side; });
}

/// "[error] toml::...: message\n --> file\n ..." on one line.
std::string one_line(std::string text) {
  std::string line;
  for (const char c : text) {
    const bool space = c == '\n' || c == ' ' || c == '\t';
    if (!space) line.push_back(c);
    if (space && !line.empty() && line.back() != ' ') line.push_back(' ');
  }
  return line.substr(0, 300);
}

}  // namespace

std::filesystem::path side_file_of(const std::filesystem::path& scene_file) {
  return std::filesystem::path(scene_file).replace_extension(".macula.toml");
}

Result<SideFile> read_side_file(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return SideFile{};
  const auto bytes = read_file(path, kMaxBytes);
  if (!bytes) return forward(bytes);
  std::string text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  // The parser reads beyond its memory where a string is no UTF-8 (toml11 3.7.1).
  if (const auto valid = base::valid_utf8_bytes(text); valid < text.size())
    return base::bad_input(base::concat("is no UTF-8 text from byte ", valid, " on"), path.string(),
                           "it must be valid TOML");
  if (measure_json(text).depth > kMaxDepth) {
    return base::bad_input("nested too deeply", path.string(),
                           base::concat("at most ", kMaxDepth, " levels"));
  }
  try {
    std::istringstream stream(std::move(text));
    return interpret(toml::parse(stream, path.string()), path.string());
  } catch (const std::exception& exception) {
    return base::bad_input(one_line(exception.what()), path.string(), "it must be valid TOML");
  }
}

}  // namespace macula::scene
