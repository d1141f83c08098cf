// What `macula-bench culling` says of errors at equal time: a rival is measured with several
// numbers of lights, and its curve of squared error over CPU time is read at a method's own time.
// One point of it would have to be carried over by some law, and there is none: chance falls with
// time, what a method leaves out for good does not. Pure.
#pragma once

#include <string_view>
#include <vector>

#include "tests/bench/report.h"

namespace macula::bench {

/// fir, power, flc_rays and tree.
bool is_rival(std::string_view method);

/// A row for every row of a culling method ("flc...") and each other rival of its scene and motion
/// that has two points or more: the rival's RMSE at the method's time over the method's own,
/// in the fovea and outside; above 1 the method is nearer. Between points a curve is straight in
/// logarithms, beyond the last variance goes on falling with time (which favours the rival); times
/// before the first have no row. Where a method met a rival more than once, a last row has the
/// geometric means.
std::vector<Fields> errors_at_equal_time(const std::vector<Fields>& rows);

}  // namespace macula::bench
