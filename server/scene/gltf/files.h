// What a scene file may read: regular files inside its own folder, up to a stated size. A path that
// leaves the folder (.., an absolute path, a symbolic link) is refused, whatever it points at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "shared/base/result.h"

namespace macula::scene::gltf {

using Bytes = std::vector<std::byte>;

inline constexpr std::uint64_t kMaxSceneFileBytes = std::uint64_t{1} << 31;
inline constexpr std::uint64_t kMaxImageFileBytes = std::uint64_t{1} << 28;

/// The whole of a regular file of at most `max_bytes`.
Result<Bytes> read_file(const std::filesystem::path& path, std::uint64_t max_bytes);

class SceneFolder {
 public:
  /// The folder that holds `scene_file`.
  explicit SceneFolder(std::filesystem::path scene_file);

  /// The file a decoded, relative URI names.
  Result<std::filesystem::path> resolve(const std::string& uri) const;

 private:
  std::filesystem::path scene_file_, folder_;
};

/// "%20" and the like become the bytes they stand for; a broken escape stays as it is.
std::string percent_decoded(const std::string& uri);

}  // namespace macula::scene::gltf
