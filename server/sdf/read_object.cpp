#include "server/sdf/read_object.h"

#include <algorithm>
#include <cmath>

namespace macula::sdf {
namespace {

using Type = JsonValue::Type;

const char* name_of(Type type) {
  switch (type) {
    case Type::Null:
      return "null";
    case Type::Boolean:
      return "true or false";
    case Type::Number:
      return "a number";
    case Type::String:
      return "a string";
    case Type::Array:
      return "an array";
    case Type::Object:
      return "an object";
  }
  return "?";
}

std::string range_of(const ParameterRule& rule) {
  const std::string range = base::concat(" in [", rule.low, ", ", rule.high, "]");
  if (rule.shape == Shape::Scalar) return "a number" + range;
  return "three numbers (or one for all three)" + range;
}

}  // namespace

void Reading::fail(const JsonValue& at, std::string what, std::string remedy) {
  if (!error_)
    error_ = Error{std::move(what), place_in(text_, at.offset, name_), std::move(remedy)};
}

ObjectReader::ObjectReader(Reading& reading, const JsonValue& object, std::string role)
    : reading_(reading), object_(object), role_(std::move(role)) {
  if (object.type != Type::Object) reading_.fail(object, role_ + " must be an object", "{ ... }");
}

const JsonValue* ObjectReader::look(std::string_view key) {
  known_.emplace_back(key);
  return object_.find(key);
}

const JsonValue* ObjectReader::find(std::string_view key, Type type) {
  const JsonValue* value = look(key);
  if (!value || value->type == type) return value;
  reading_.fail(*value, base::concat(key, " must be ", name_of(type)), "correct or remove it");
  return nullptr;
}

const JsonValue* ObjectReader::required(std::string_view key, Type type) {
  const JsonValue* value = find(key, type);
  if (!value) reading_.fail(object_, base::concat(role_, " lacks \"", key, "\""), name_of(type));
  return value;
}

std::optional<DVec3> ObjectReader::value_of(const JsonValue& value, const ParameterRule& rule) {
  const auto allowed = [&rule](const JsonValue& number) {
    return number.type == Type::Number && number.number >= rule.low && number.number <= rule.high;
  };
  if (allowed(value)) return DVec3{value.number};
  const bool three = rule.shape == Shape::Vector && value.type == Type::Array &&
                     value.items.size() == 3 &&
                     std::all_of(value.items.begin(), value.items.end(), allowed);
  if (three) return DVec3{value.items[0].number, value.items[1].number, value.items[2].number};
  reading_.fail(value, base::concat(rule.key, " is not ", range_of(rule)), "correct it");
  return std::nullopt;
}

Parameter ObjectReader::read_track(const JsonValue& value, const ParameterRule& rule) {
  ObjectReader object(reading_, value, base::concat("the keys of ", rule.key));
  Track track;
  if (const JsonValue* loop = object.find("loop", Type::Boolean)) track.loops = loop->boolean;
  if (const JsonValue* keys = object.required("keys", Type::Array)) {
    if (keys->items.empty()) reading_.fail(*keys, "no keys", "[[seconds, value], ...]");
    for (const JsonValue& key : keys->items) {
      const bool pair =
          key.type == Type::Array && key.items.size() == 2 && key.items[0].type == Type::Number;
      const bool later =
          pair && (track.times_s.empty() || key.items[0].number > track.times_s.back());
      if (!later) {
        reading_.fail(key, "not a key", "[seconds, value] with seconds that increase");
        return {};
      }
      track.times_s.push_back(key.items[0].number);
      track.values.push_back(value_of(key.items[1], rule).value_or(DVec3{0.0}));
    }
  }
  object.finish();
  if (!reading_.sound()) return {};
  reading_.tracks->push_back(std::move(track));
  return {reading_.tracks->back().values.front(),
          static_cast<std::int32_t>(reading_.tracks->size() - 1)};
}

Parameter ObjectReader::parameter(const ParameterRule& rule) {
  const JsonValue* value = look(rule.key);
  if (!value) {
    if (!rule.standard)
      reading_.fail(object_, base::concat(role_, " lacks \"", rule.key, "\""), range_of(rule));
    return {DVec3{rule.standard.value_or(0.0)}, -1};
  }
  if (value->type == Type::Object) return read_track(*value, rule);
  return {value_of(*value, rule).value_or(DVec3{0.0}), -1};
}

double ObjectReader::number(std::string_view key, double standard, double low, double high) {
  const JsonValue* value = look(key);
  if (!value) return standard;
  return value_of(*value, {key, Shape::Scalar, standard, low, high}).value_or(DVec3{standard}).x;
}

DVec3 ObjectReader::vector(std::string_view key, std::optional<DVec3> standard, double low,
                           double high) {
  const JsonValue* value = look(key);
  const ParameterRule rule{key, Shape::Vector, std::nullopt, low, high};
  if (!value && !standard)
    reading_.fail(object_, base::concat(role_, " lacks \"", key, "\""), range_of(rule));
  if (!value) return standard.value_or(DVec3{1.0});
  return value_of(*value, rule).value_or(DVec3{1.0});
}

DVec3 ObjectReader::color(std::string_view key, const DVec3& standard, double high) {
  return vector(key, standard, 0.0, high);
}

std::string ObjectReader::text(std::string_view key, std::string standard) {
  const JsonValue* value = find(key, Type::String);
  return value ? value->text : standard;
}

int ObjectReader::one_of(std::string_view key, std::string_view allowed, int standard) {
  const JsonValue* value = find(key, Type::String);
  if (!value) return standard;
  int index = 0;
  for (std::string_view rest = allowed; !rest.empty(); ++index) {
    const std::size_t comma = rest.find(", ");
    if (rest.substr(0, comma) == value->text) return index;
    rest = comma == std::string_view::npos ? std::string_view{} : rest.substr(comma + 2);
  }
  reading_.fail(*value, base::concat(key, " is '", value->text, "'"),
                base::concat("one of ", allowed));
  return standard;
}

std::vector<const JsonValue*> ObjectReader::objects(std::string_view key) {
  std::vector<const JsonValue*> result;
  const JsonValue* value = look(key);
  if (value && value->type == Type::Object) result.push_back(value);
  if (value && value->type == Type::Array) {
    for (const JsonValue& item : value->items) result.push_back(&item);
  }
  if (value && value->type != Type::Object && value->type != Type::Array)
    reading_.fail(*value, base::concat(key, " must be an object or an array of objects"),
                  "[{...}]");
  return result;
}

void ObjectReader::finish() {
  for (const auto& [key, value] : object_.members) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    std::string list;
    for (const std::string& word : known_) list += (list.empty() ? "" : ", ") + word;
    reading_.fail(value, base::concat("unknown key '", key, "' of ", role_), "allowed: " + list);
  }
}

}  // namespace macula::sdf
