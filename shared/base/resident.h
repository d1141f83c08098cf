// How much memory this process holds.
#pragma once

#include <cstddef>

namespace macula::base {

/// Resident pages, in bytes, as Linux tells it; 0 where it does not.
std::size_t resident_bytes();

}  // namespace macula::base
