// A ball of points relative to a program's eye, meters. Inside server/sdf and its tests.
#pragma once

#include "shared/math/vec.h"

namespace macula::sdf {

struct Ball {
  Vec3 centre{0.0F};
  float radius = 0.0F;
};

}  // namespace macula::sdf
