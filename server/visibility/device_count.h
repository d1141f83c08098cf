// How many of Embree's devices this process has made: for tests that what needs none makes none.
#pragma once

#include <cstdint>

namespace macula::visibility {

std::uint64_t devices_made();

}  // namespace macula::visibility
