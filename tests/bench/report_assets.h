// What makes a report's page look and behave: a style sheet and a script. Texts, no logic here.
#pragma once

#include <string_view>

namespace macula::bench {

extern const std::string_view kPageStyle, kPageScript;

}  // namespace macula::bench
