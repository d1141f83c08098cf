// Work that falls into independent parts, for whoever has no scheduler: import and start-up.
#pragma once

#include <cstddef>
#include <functional>

namespace macula::base {

/// Calls body(i) once for every i < count, in any order, from as many threads as the machine runs
/// at once; returns when all have returned. The body writes to what belongs to its i alone. The
/// first exception of a body leaves here; parts not begun by then are not begun.
void for_each_index(std::size_t count, const std::function<void(std::size_t)>& body);

}  // namespace macula::base
