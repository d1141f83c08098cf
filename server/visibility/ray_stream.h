// Ray streams: up to 256 rays as one structure of arrays, and what they met. World space, meters,
// float; directions need not be unit: t counts in lengths of the direction. Plain values, filled
// and read by one thread. Entries at and beyond `count` hold nothing meaningful.
#pragma once

#include <cstdint>

#include "shared/base/check.h"
#include "shared/math/vec.h"

namespace macula::visibility {

inline constexpr int kStreamCapacity = 256;
inline constexpr std::uint32_t kNothing = 0xFFFFFFFFU;

/// Whether a ray meets a surface that hides only a part of what lies behind it (alpha mode Blend).
/// Other surfaces do not ask.
using BlendRule = std::uint32_t;
/// Met with the probability of its coverage: by chance, independent between seeds of 31 bits and
/// between surfaces. The mean over seeds is what blending front to back gives, also for shadows.
constexpr BlendRule blend_by_chance(std::uint32_t seed) {
  return seed | 0x8000'0000U;
}
/// Met where its coverage is at least `least`, in [0, 1): a mask.
constexpr BlendRule blend_from(float least) {
  return static_cast<BlendRule>(least * 0x1p31F);
}

/// A ray meets a surface at t in (tnear, tfar]. tfar may be +infinity; tfar < tnear: an idle ray
/// that meets nothing. Order rays so that 4x4 (or 4x2) neighbours are consecutive: packets follow
/// order.
struct alignas(64) RayStream {
  float ox[kStreamCapacity], oy[kStreamCapacity], oz[kStreamCapacity];  ///< origins, meters
  float dx[kStreamCapacity], dy[kStreamCapacity], dz[kStreamCapacity];  ///< directions, any length
  float tnear[kStreamCapacity], tfar[kStreamCapacity];
  BlendRule blend[kStreamCapacity];  ///< read only where TriangleScene::blends()
  int count = 0;

  void clear() { count = 0; }
  bool full() const { return count == kStreamCapacity; }
  /// Appends one ray; returns its index in the stream.
  int push(const Vec3& origin, const Vec3& direction, float near, float far,
           BlendRule rule = blend_from(0.5F)) {
    MACULA_DCHECK(!full());
    const int i = count++;
    ox[i] = origin.x, oy[i] = origin.y, oz[i] = origin.z;
    dx[i] = direction.x, dy[i] = direction.y, dz[i] = direction.z;
    tnear[i] = near, tfar[i] = far;
    blend[i] = rule;
    return i;
  }
  Vec3 origin(int i) const { return {ox[i], oy[i], oz[i]}; }
  Vec3 direction(int i) const { return {dx[i], dy[i], dz[i]}; }
};

/// The closest hit of one ray; see HitStream.
struct Hit {
  float t = 0.0F, u = 0.0F, v = 0.0F;
  Vec3 normal{0.0F};
  std::uint32_t instance = 0, triangle = 0;
  /// How far off its surface a ray from a point of a distance field starts, meters.
  float gap = 0.0F;
};

/// The closest hit of every ray. Both sides of a triangle are hit; the point is
/// (1 - u - v) p0 + u p1 + v p2, more exact near the surface than origin + t direction.
struct alignas(64) HitStream {
  float t[kStreamCapacity];
  float u[kStreamCapacity], v[kStreamCapacity];
  /// Unit geometric normal in the world, towards the front face (the side from which object-space
  /// vertices run counter-clockwise, also under mirroring transforms).
  float nx[kStreamCapacity], ny[kStreamCapacity], nz[kStreamCapacity];
  std::uint32_t instance[kStreamCapacity];  ///< index into Scene::instances; kNothing: no hit
  std::uint32_t triangle[kStreamCapacity];  ///< index into Mesh::triangles
  float gap[kStreamCapacity];               ///< as Hit::gap; written for distance fields only

  bool hit(int i) const { return instance[i] != kNothing; }
  Vec3 normal(int i) const { return {nx[i], ny[i], nz[i]}; }
  /// Of a ray that hit.
  Hit at(int i) const { return {t[i], u[i], v[i], normal(i), instance[i], triangle[i], gap[i]}; }
};

/// 1 where something lies at t in (tnear, tfar], else 0.
struct alignas(64) OcclusionStream {
  std::uint8_t occluded[kStreamCapacity];
};

}  // namespace macula::visibility
