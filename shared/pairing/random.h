// Where nonces, scalars and codes come from. A function, so that tests can pair from a seed.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

namespace macula::pairing {

/// Fills the bytes with uniform random ones.
using Random = std::function<void(std::span<unsigned char>)>;

/// The operating system's generator; thread-safe.
Random system_random();

}  // namespace macula::pairing
