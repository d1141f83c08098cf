// EnvironmentLight: what comes from beyond the scene, ready to be looked at and to be sampled. The
// picture is read bilinearly; directions are drawn from a table that gives every cell of it the
// probability of its share of luminance x solid angle, so that the density is positive wherever
// light comes from. World directions, unit; linear Rec.709 radiance. Immutable; safe from any
// thread; holds a copy. Inverse of the cumulative shares by rows, then columns (Pharr, Jakob,
// Humphreys, "Physically Based Rendering", 4th ed. 2023, 12.5).
#pragma once

#include <cstdint>
#include <vector>

#include "server/scene/scene.h"

namespace macula::lights {

struct EnvironmentSample {
  Vec3 to_light{0.0F};  ///< unit
  float pdf = 0.0F;     ///< 1/sr, > 0
};

class EnvironmentLight {
 public:
  /// Black.
  EnvironmentLight() = default;
  explicit EnvironmentLight(const scene::Environment& environment);

  Rgb radiance(const Vec3& direction) const;
  /// The same from everywhere: no direction is better than another, and there is no table.
  bool is_constant() const { return cells_.empty(); }
  /// A direction for u in [0, 1)^2; stratified u give stratified directions.
  EnvironmentSample sample(const Vec2& u) const;
  /// Density of sample() at a direction, 1/sr.
  float pdf(const Vec3& direction) const;

 private:
  Vec3 in_picture(const Vec3& direction) const;
  void make_table();
  double cell_weight(int column, int row) const;
  float cell_solid_angle(int column, int row) const;
  Rgb texel(int x, int y) const;

  image::Plane<Rgb> radiance_{1, 1, Rgb{0.0F}};  ///< scaled
  float cos_yaw_ = 1.0F, sin_yaw_ = 0.0F;
  int columns_ = 1, rows_ = 1;
  int texels_ = 1;               ///< side of a cell of the table; the last ones may be smaller
  std::vector<float> cells_;     ///< cumulative within each row, ends at 1; empty: constant
  std::vector<float> row_ends_;  ///< cumulative over rows, ends at 1
  std::vector<double> cosines_;  ///< to +Y, where the rows begin, and of the last one's end
};

}  // namespace macula::lights
