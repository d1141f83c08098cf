// One JSON object read key by key: ranges are checked, the first thing wrong is remembered with its
// place, and in the end a key that nobody asked for is refused. Inside server/sdf.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/sdf/field.h"
#include "server/sdf/json_tree.h"
#include "server/sdf/kinds.h"
#include "shared/base/text.h"

namespace macula::sdf {

/// What all readers of one text share.
class Reading {
 public:
  Reading(std::string_view text, std::string name) : text_(text), name_(std::move(name)) {}

  void fail(const JsonValue& at, std::string what, std::string remedy);
  bool sound() const { return !error_; }
  const std::optional<Error>& error() const { return error_; }

  std::vector<Track>* tracks = nullptr;  ///< where keyframes go

 private:
  std::string_view text_;
  std::string name_;
  std::optional<Error> error_;
};

class ObjectReader {
 public:
  /// `role` names the object in messages: "a node".
  ObjectReader(Reading& reading, const JsonValue& object, std::string role);

  /// Nothing where the key is absent or of another type; the latter is an error.
  const JsonValue* find(std::string_view key, JsonValue::Type type);
  const JsonValue* required(std::string_view key, JsonValue::Type type);
  double number(std::string_view key, double standard, double low, double high);
  /// No standard: the key must be there.
  DVec3 vector(std::string_view key, std::optional<DVec3> standard, double low, double high);
  /// A vector in [0, high], or one number for a gray.
  DVec3 color(std::string_view key, const DVec3& standard, double high);
  std::string text(std::string_view key, std::string standard);
  /// The index of the word in `allowed` ("a, b, c").
  int one_of(std::string_view key, std::string_view allowed, int standard);
  /// A constant, or {"keys": [[seconds, value], ...], "loop": true}. A vector may be one number for
  /// all three components.
  Parameter parameter(const ParameterRule& rule);
  /// An object or an array of objects; empty where the key is absent.
  std::vector<const JsonValue*> objects(std::string_view key);
  void finish();

 private:
  const JsonValue* look(std::string_view key);
  std::optional<DVec3> value_of(const JsonValue& value, const ParameterRule& rule);
  Parameter read_track(const JsonValue& value, const ParameterRule& rule);

  Reading& reading_;
  const JsonValue& object_;
  std::string role_;
  std::vector<std::string> known_;
};

}  // namespace macula::sdf
