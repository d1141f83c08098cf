// VirtualLightTable: virtual point lights as vectors read them, dealt out to classes: light i
// belongs to class i modulo classes, so that each class alone is a sample of them all. Points that
// ask one class see a part of the light, as many times as strong (interleaved sampling, Keller and
// Heidrich 2001). World space, meters, linear Rec.709. Immutable once made; holds copies.
// lights::arriving of virtual_point_light.h is its oracle. Visibility is the caller's.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/lights/placed_lights.h"
#include "server/lights/virtual_point_light.h"

namespace macula::lights {

class VirtualLightTable {
 public:
  /// None.
  VirtualLightTable() = default;
  /// `classes` >= 1; `least_m` >= 0: nearer than that and than its footprint's radius, light
  /// arrives as from there.
  VirtualLightTable(std::span<const VirtualPointLight> lights, int classes, float least_m);

  bool empty() const { return count_ == 0; }
  std::size_t size() const { return count_; }
  int classes() const { return classes_; }
  /// Lights of the largest class, rounded up to whole vectors.
  std::size_t rounds() const { return rounds_; }
  /// Row of the `round`-th light of a class, for LightDraws::light; one without flux past the last.
  std::uint32_t row(int light_class, std::size_t round) const {
    return static_cast<std::uint32_t>(static_cast<std::size_t>(light_class) * rounds_ + round);
  }
  /// Row of a light by its place in the span the table was made from.
  std::uint32_t row_of(std::size_t light) const {
    const auto classes = static_cast<std::size_t>(classes_);
    return row(static_cast<int>(light % classes), light / classes);
  }

  /// Light arriving at the first `count` points from a drawn row each, the irradiance times
  /// inverse_probability; none where that is 0, behind the light and in its plane.
  void arriving(const LightDraws& draws, const sampling::Vec3Batch& points, std::size_t count,
                AreaArrivalBatch& out) const;
  /// Luminance of what every row of a class brings to a surface of the unit `normal` at `point`,
  /// W/m^2; weights.size() == rounds().
  void weigh(int light_class, const Vec3& point, const Vec3& normal,
             std::span<float> weights) const;

  // ---- for vectors ----
  static constexpr std::size_t kRowFloats = 16;
  /// Position, normal, flux over pi, span, least distance squared; by row.
  std::span<const float> rows() const { return rows_; }
  static constexpr std::size_t kColumns = 8;
  /// The same one kind after another: x of all rows, y, z, normal, luminance for flux, least
  /// distance squared.
  std::span<const float> columns() const { return columns_; }
  float least_m() const { return least_m_; }

 private:
  void set(std::size_t row, const VirtualPointLight& light);

  std::vector<float> rows_, columns_;
  std::size_t count_ = 0, rounds_ = 0;
  int classes_ = 1;
  float least_m_ = 0.0F;
};

}  // namespace macula::lights
