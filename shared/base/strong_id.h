// StrongId<Tag>: a 64-bit number that cannot be confused with another kind of number.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>

namespace macula::base {

template <class Tag>
struct StrongId {
  std::uint64_t value = 0;
  friend auto operator<=>(const StrongId&, const StrongId&) = default;
};

}  // namespace macula::base

template <class Tag>
struct std::hash<macula::base::StrongId<Tag>> {
  std::size_t operator()(const macula::base::StrongId<Tag>& id) const noexcept {
    return std::hash<std::uint64_t>{}(id.value);
  }
};
