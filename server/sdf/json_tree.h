// JSON as a tree whose every value knows where it stands, so that whoever reads it can answer a
// wrong value with line and column. The only place that sees the JSON library.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "shared/base/result.h"

namespace macula::sdf {

struct JsonMember;

struct JsonValue {
  enum class Type { Null, Boolean, Number, String, Array, Object };

  Type type = Type::Null;
  bool boolean = false;
  double number = 0.0;
  std::string text;
  std::vector<JsonValue> items;     ///< of an array
  std::vector<JsonMember> members;  ///< of an object, in the file's order
  std::size_t offset = 0;           ///< first byte of the value

  const JsonValue* find(std::string_view key) const;
};

struct JsonMember {
  std::string name;
  JsonValue value;
};

inline constexpr std::size_t kMaxJsonDepth = 64;
inline constexpr std::size_t kMaxJsonValues = 2'000'000;

/// "name: line 3, column 14", both from 1; columns count bytes.
std::string place_in(std::string_view text, std::size_t offset, const std::string& name);

/// `name` is what errors call the text. Errors: what the library says of broken JSON, a key that
/// stands twice, nesting or size beyond the limits above; each with its place.
Result<JsonValue> parse_json(std::string_view text, const std::string& name);

}  // namespace macula::sdf
