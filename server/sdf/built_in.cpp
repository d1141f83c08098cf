#include <array>

#include "server/sdf/built_in_text.h"
#include "server/sdf/read.h"

namespace macula::sdf {

std::span<const BuiltInField> built_in_fields() {
  static const std::array kFields{
      BuiltInField{"primitives", "simple shapes on a checkered plane, under the sky",
                   kText_primitives},
      BuiltInField{"columns", "a closed hall of repeated columns and five moving lights",
                   kText_columns},
      BuiltInField{"temple", "a temple on a procedural cliff above the sea", kText_temple},
  };
  return kFields;
}

}  // namespace macula::sdf
