// What kernel `ray` remembers between frames: for every cell of every view its colour, the light
// that chance estimates, and how much both are worth. A record belongs to one session.
#pragma once

#include <cstdint>
#include <vector>

#include "server/kernels/frame_buffers.h"
#include "server/kernels/history.h"
#include "server/kernels/ray/fresh.h"
#include "server/reconstruction/texel.h"
#include "shared/foveation/pixel_grid.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"
#include "shared/math/pose.h"

namespace macula::kernels::ray {

using image::Plane;
using reconstruction::Texel;

/// A cell's cache info (section 3.4), never interpolated.
struct CacheInfo {
  float samples = 0.0F;        ///< rho of the colour
  float light_samples = 0.0F;  ///< rho of the light
  std::uint32_t touched = 0;   ///< clock of the last sample, modulo 2^32
};

/// How the memory holds radiance: by its square root, about as displays encode it. Moving it
/// between cells blurs it, and a blur of radiance would brighten what is shown of fine bright
/// detail.
inline Rgb radiance_of(const Texel& held) {
  return held.rgb() * held.rgb();
}

/// One view's picture. Shown: color + sampled. The light that chance estimates is remembered as
/// what it brings and what it met: its mean per unit of reflectance is the quotient of the two
/// means. A mean of quotients would be too bright where a glint brightens what reflects little.
/// `sampled` and `reflectance` are empty in scenes where chance estimates nothing.
struct Cache {
  Plane<Texel> color;        ///< emission and lights without extent, as its root
  Plane<Texel> sampled;      ///< area, ambient and environment light as reflected, as its root
  Plane<Texel> reflectance;  ///< directional, [0, 1]
  Plane<CacheInfo> info;
  /// 1/m, of view depth: 0 where nothing was hit, kNothing where nothing is remembered.
  Plane<float> inverse_depth;
  Plane<std::uint32_t> surface_id;  ///< empty unless the frame asked for it; so the next two
  Plane<Vec3> normal;
  Plane<Rgb> albedo;

  static constexpr float kNothing = -1.0F;
  bool has_light() const { return !sampled.empty(); }
  bool remembers(int x, int y) const { return inverse_depth(x, y) >= 0.0F; }
  /// Radiance.
  Rgb shown(int x, int y) const {
    const Rgb radiance = radiance_of(color(x, y));
    return has_light() ? radiance + radiance_of(sampled(x, y)) : radiance;
  }
};

/// Where an eye was, by the clock of the cache: as many frames in motion as it holds.
class EyePath {
 public:
  /// `clock` is the last one's or the next.
  void note(std::uint32_t clock, const DVec3& eye);
  /// How far the eye has come since: meters, as `world_from_view` sees it, by the clocks that have
  /// passed. What is longer ago than the last is as far as that. Not before a note.
  std::vector<Vec3> ways(const Pose& world_from_view) const;
  std::uint32_t newest() const { return newest_; }

 private:
  static constexpr std::uint32_t kHeld = 64;  ///< the mask's longest wait at p = .05 is 34 frames
  std::vector<DVec3> eyes_;                   ///< of the last clocks, at clock modulo kHeld
  std::uint32_t newest_ = 0;
};

struct ViewMemory {
  Pose world_from_view;
  PixelGrid grid;
  EyePath eyes;
  Cache now, then;       ///< of the last frame, and room for the one before
  float density = 1.0F;  ///< what probabilities below 1 are scaled by, (0, 1]
  FreshSamples fresh;    ///< room for a frame's samples
};

struct RayRecord final : HistoryRecord {
  std::vector<ViewMemory> views;  ///< empty: nothing is remembered
  const void* scene = nullptr;    ///< whose light this is; only compared
  unsigned wanted = 0;            ///< PlaneFlag bits the caches have
  std::uint32_t clock = 0;        ///< advances as AgeRule says
};

/// Sizes the cache's planes; contents are lost where the size changes.
void prepare_cache(Cache& cache, int width, int height, bool has_light, unsigned wanted);

}  // namespace macula::kernels::ray
