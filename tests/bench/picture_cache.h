// Pictures that are dear to make, kept in files named by a hash of everything they depend on.
#pragma once

#include <cstring>
#include <filesystem>
#include <functional>
#include <span>
#include <type_traits>

#include "server/scene/scene.h"
#include "shared/image/plane.h"
#include "shared/math/hash.h"

namespace macula::bench {

using image::Plane;

/// Raise it when pictures change for a reason the hash cannot see: the renderer's own.
inline constexpr std::uint64_t kRendererVersion = 1;

class Hasher {
 public:
  template <class T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    add_bytes(&value, sizeof(T));
  }
  template <class T>
  void add_all(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add_bytes(values.data(), values.size_bytes());
  }
  std::uint64_t value() const { return value_; }

 private:
  void add_bytes(const void* data, std::size_t bytes) {
    const auto* at = static_cast<const char*>(data);
    for (std::size_t i = 0; i < bytes; i += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, at + i, std::min<std::size_t>(8, bytes - i));
      value_ = math::hash_combine(value_, word);
    }
    value_ = math::hash_combine(value_, bytes);
  }
  std::uint64_t value_ = kRendererVersion;
};

/// Of all that the pictures of experiments depend on: what meshes look like, where instances and
/// lights are at rest, what shines.
std::uint64_t hash_of(const scene::Scene& scene);

class PictureCache {
 public:
  /// `folder` empty: $XDG_CACHE_HOME/macula-bench, or the same below ~/.cache.
  explicit PictureCache(std::filesystem::path folder);

  /// The picture of that hash and size, linear radiance; made where there is none yet.
  Plane<Rgb> at(std::uint64_t hash, int width_px, int height_px,
                const std::function<Plane<Rgb>()>& make) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace macula::bench
