#include "shared/foveation/gaze_filter.h"

namespace macula::foveation {

Gaze GazeFilter::update(const Gaze& measured) {
  const float length = glm::length(measured.direction);
  const bool usable = measured.valid && math::is_finite(measured.direction) &&
                      std::isfinite(length) && length > 0.0F;
  if (usable) {
    last_ = measured;
    last_.direction = measured.direction / length;
    return last_;
  }
  Gaze held = last_;
  held.valid = false;
  held.confidence = 0.0F;
  return held;
}

}  // namespace macula::foveation
