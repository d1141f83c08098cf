// Half-references of `macula-bench ray`: two independent pictures of many samples, so that the mean
// of (x - r1)(x - r2) estimates the squared error against the true picture without bias. Cached in
// files named by a hash of everything they depend on: scene, pose, raster, samples.
#pragma once

#include "tests/bench/picture_cache.h"
#include "tests/bench/ray_setting.h"

namespace macula::bench {

struct HalfReferences {
  Plane<Rgb> first, second;  ///< linear radiance
};

class ReferenceBook {
 public:
  /// `folder` empty: $XDG_CACHE_HOME/macula-bench, or the same below ~/.cache.
  ReferenceBook(const RaySetting& setting, std::filesystem::path folder, int samples);

  HalfReferences at(const Pose& pose, scheduling::TileScheduler& scheduler) const;

 private:
  Plane<Rgb> half(const Pose& pose, std::uint64_t seed, scheduling::TileScheduler& scheduler) const;

  Plane<Rgb> rendered(const Pose& pose, std::uint64_t seed,
                      scheduling::TileScheduler& scheduler) const;

  const RaySetting& setting_;
  PictureCache cache_;
  int samples_;
  std::uint64_t scene_hash_;
};

}  // namespace macula::bench
