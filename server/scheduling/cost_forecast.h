// CostForecast: what the tiles of a frame's passes will cost, from what those of the last frame
// did. A tile says where in its view it lies and how much work it is, as its pass counts it (cells
// that the rate lets it trace, nodes that its cuts have); what a unit of work cost near the same
// place of the world in the last frame is looked up where the head's turn has moved it. Pure: every
// rank has the same numbers and comes to the same answer.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "shared/math/vec.h"

namespace macula::scheduling {

/// Where a tile lies, and its work.
struct TilePlace {
  std::uint32_t view = 0;
  Vec2 at{0.5F};      ///< its middle as a share of the view's grid, [0, 1]^2
  float work = 1.0F;  ///< any unit, the same within a pass, > 0
};

/// The place in the last frame's view that shows what `now` shows; nullopt: it was not in sight.
using PlaceThen = std::function<std::optional<Vec2>(const TilePlace& now)>;

class CostForecast {
 public:
  /// A new frame: its passes will be asked for, and told of, in the order in which they run.
  void begin_frame(PlaceThen place_then);
  /// Expected cost of the tiles of the frame's next pass, in ms where the last frame had the same
  /// pass, else in units of work.
  std::vector<float> expect(std::span<const TilePlace> tiles);
  /// Measured costs of the pass that was asked for last, in ms.
  void learn(std::span<const TilePlace> tiles, std::span<const float> costs_ms);

 private:
  static constexpr int kSide = 24;  ///< texels along a side of a view's map
  /// Cost a unit of work over one view.
  struct Map {
    std::array<float, kSide * kSide> cost{}, work{};
    float mean = 0.0F;  ///< 0: nothing is known
    float at(const Vec2& place) const;
  };
  using Pass = std::vector<Map>;  ///< by view

  static std::size_t texel_of(const Vec2& place);

  PlaceThen place_then_;
  std::vector<Pass> last_, now_;
  std::size_t asked_ = 0;  ///< passes of this frame
};

}  // namespace macula::scheduling
