// Noisy light of a picture and the surfaces that it lies on, as planes that loops over vectors
// read.
#pragma once

#include <array>

#include "server/reconstruction/wide_plane.h"

namespace macula::reconstruction {

/// What a picture's cells show. World, meters.
struct SurfacePlanes {
  WidePlane x, y, z;                       ///< where
  WidePlane normal_x, normal_y, normal_z;  ///< unit
  WidePlane distance_m;                    ///< to the eye; 0: no surface

  int width() const { return x.width(); }
  int height() const { return x.height(); }
  std::array<WidePlane*, 7> all() {
    return {&x, &y, &z, &normal_x, &normal_y, &normal_z, &distance_m};
  }
  void resize(int width, int height) {
    for (WidePlane* plane : all()) plane->resize(width, height);
  }
};

/// Light over reflectance, linear, and what is known of its noise.
struct LightPlanes {
  WidePlane r, g, b;
  WidePlane luminance;
  WidePlane variance;  ///< of the luminance

  std::array<WidePlane*, 5> all() { return {&r, &g, &b, &luminance, &variance}; }
  void resize(int width, int height) {
    for (WidePlane* plane : all()) plane->resize(width, height);
  }
};

/// How far planes of like surfaces may be apart: a part of what lies between two points, and a part
/// of the distance, about what a cell spans. Normals closer than that in cosine.
inline constexpr float kApartOfBetween = 0.125F, kApartOfDistance = 2e-3F, kLeastFacing = 0.8F;

}  // namespace macula::reconstruction
