// The texts of scenes/*.sdf.json, put into the program by embed.cmake. Inside server/sdf.
#pragma once

#include <string_view>

namespace macula::sdf {

extern const std::string_view kText_primitives, kText_columns, kText_temple;

}  // namespace macula::sdf
