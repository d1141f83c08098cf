// Holds the last usable gaze: non-finite or zero directions are replaced by the last valid one,
// then by the view axis; directions are normalised. One filter per eye.
#pragma once

#include "shared/foveation/gaze.h"

namespace macula::foveation {

class GazeFilter {
 public:
  /// The gaze to use now; `.valid` is false when it had to be held or made up.
  Gaze update(const Gaze& measured);

 private:
  Gaze last_;
};

}  // namespace macula::foveation
