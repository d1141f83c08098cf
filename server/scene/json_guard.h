// A look at JSON text before a recursive parser sees it: how deep it nests and how many values it
// holds. Costs one pass and no memory; says nothing about whether the text is valid.
#pragma once

#include <cstddef>
#include <string_view>

namespace macula::scene {

struct JsonExtent {
  std::size_t depth = 0;    ///< deepest nesting of objects and arrays
  std::size_t objects = 0;  ///< objects and arrays
  std::size_t commas = 0;   ///< outside strings: about the number of values
};
JsonExtent measure_json(std::string_view text);

}  // namespace macula::scene
