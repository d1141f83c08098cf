// Where one eye looks. Per eye: the two directions differ by vergence.
#pragma once

#include "shared/math/vec.h"

namespace macula::foveation {

struct Gaze {
  Vec3 direction{0.0F, 0.0F,
                 -1.0F};    ///< unit vector in this eye's view space; may point off-screen
  bool valid = true;        ///< false: not tracked now, direction is the last known or the axis
  float confidence = 1.0F;  ///< [0, 1] as the tracker reports it
};

}  // namespace macula::foveation

namespace macula {
using foveation::Gaze;
}
