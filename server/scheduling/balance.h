// Balance: which rank runs which tile of a pass. Pure, and the same on every rank: pictures do not
// depend on it, but all must agree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace macula::scheduling {

/// Predicted: by what every tile is expected to cost, so that ranks finish together. Stripes: as
/// many consecutive tiles each. Dynamic: whoever is free takes the next, at run time.
enum class Balance { Predicted, Stripes, Dynamic };
inline constexpr std::string_view kBalanceNames[] = {"predicted", "stripes", "dynamic"};

/// Tiles of each rank in the order in which they are to be run, costliest first: each goes to the
/// rank that has least so far (Graham 1969, longest processing time). Costs are >= 0, any unit.
std::vector<std::vector<std::uint32_t>> assign_by_cost(std::span<const float> costs, int ranks);
std::vector<std::vector<std::uint32_t>> assign_stripes(std::size_t tiles, int ranks);

}  // namespace macula::scheduling
