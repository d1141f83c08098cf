// An extreme: an input at the edge of what is possible, the harmless one that it must look like,
// and a near miss that must not, without which the comparison would prove nothing.
#pragma once

#include <vector>

#include "tests/stability/shot.h"

namespace macula::stability {

enum class In { BothModes, Exact };  ///< Exact: what Fast shows is not the plain picture, by design

struct Extreme {
  const char* name;
  Shot (*plain)();
  Shot (*extreme)();
  Shot (*near_miss)();
  double relative_mse = 1e-3;   ///< largest that counts as the same picture
  double strange_depths = 0.0;  ///< largest share
  In in = In::BothModes;
  double depth_error = 1e-4;  ///< of a cell's depth; beyond it the depth is strange
  double noise = 0.0;         ///< relative MSE that mode Fast may add by other random numbers
};

std::vector<Extreme> places();    ///< scale, distance from the origin
std::vector<Extreme> views();     ///< fields of view, shapes of pictures, gaze, frame numbers
std::vector<Extreme> lights();    ///< none, one, coincident, extreme ones
std::vector<Extreme> surfaces();  ///< degenerate geometry, extreme materials
std::vector<Extreme> fields();    ///< distance fields

}  // namespace macula::stability
