// Distance scenes from files: JSON whose schema README.md of this room gives.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "server/sdf/field.h"
#include "shared/base/result.h"

namespace macula::sdf {

/// What files may hold at most, definitions used counted as often as they are used.
inline constexpr std::size_t kMaxNodes = 65536;
inline constexpr std::size_t kMaxFileBytes = std::size_t{1} << 24;

/// Errors name file, line, column, what is wrong and what is allowed.
Result<Field> read_field(const std::string& path);
/// `name` is what errors and the field itself are called.
Result<Field> parse_field(std::string_view text, const std::string& name);

/// Scenes that come with the program, as the texts of their files: something to copy and to edit.
struct BuiltInField {
  std::string_view name, summary, text;
};
std::span<const BuiltInField> built_in_fields();

}  // namespace macula::sdf
