// RowWarp: BackwardWarp for a whole row of a picture at once, in vectors, from inverse depths: a
// plane's inverse depth is linear on the tangent plane, and 0 is infinitely far. Positions in
// meters. Immutable; safe from any thread.
#pragma once

#include <span>
#include <vector>

#include "server/reconstruction/axis_locator.h"
#include "shared/foveation/pixel_grid.h"
#include "shared/math/pose.h"

namespace macula::reconstruction {

/// Where a row's cells lay in the earlier picture; each plane has the row's width.
struct RowPlaces {
  std::vector<float> x, y;  ///< continuous cell coordinates, any value outside the grid too
  std::vector<float> inverse_depth;  ///< 1/m, of view depth then; negative: behind the eye then

  void resize(std::size_t width) { x.resize(width), y.resize(width), inverse_depth.resize(width); }
};

class RowWarp {
 public:
  RowWarp(const Pose& world_from_now, const PixelGrid& grid_now, const Pose& world_from_then,
          const PixelGrid& grid_then);

  struct Place {
    float x = 0.0F, y = 0.0F, inverse_depth = 0.0F;
  };
  /// Where the eye stands and looks now, in the view frame then.
  struct Eye {
    Mat3 rotation{1.0F};
    Vec3 origin{0.0F};

    Eye() = default;
    Eye(const Pose& world_from_now, const Pose& world_from_then);
  };
  /// Of one cell now, seen at an inverse depth >= 0 of 1/m.
  Place then(int x, int y, float inverse_depth) const { return then(x, y, inverse_depth, eye_); }
  /// The same, had the eye come from elsewhere: what it sees moved by itself.
  Place then(int x, int y, float inverse_depth, const Eye& eye) const;
  /// Inverse depth now of what lies at a cell position then.
  float inverse_depth_now(const Vec2& tangent_then, float inverse_depth_then) const;
  /// The function above for row y: inverse_depth.size() is the grid's width.
  void row(int y, std::span<const float> inverse_depth, RowPlaces& places) const;
  /// The same for any x tangents on row y, as many as inverse depths.
  void row(int y, std::span<const float> tangent_x, std::span<const float> inverse_depth,
           RowPlaces& places) const;
  /// Of the centres of the columns and of a row now.
  std::span<const float> tangents_x() const { return tangent_x_; }
  float tangent_y(int y) const { return tangent_y_[y]; }

 private:
  Eye eye_;
  std::vector<float> tangent_x_, tangent_y_;  ///< of the centres now
  AxisLocator x_then_, y_then_;
};

}  // namespace macula::reconstruction
