// What a scene file may read: regular files inside its own folder, up to a stated size. A path that
// leaves the folder (.., an absolute path, a symbolic link) is refused, whatever it points at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "shared/base/result.h"

namespace macula::scene {

using Bytes = std::vector<std::byte>;

inline constexpr std::uint64_t kMaxSceneFileBytes = std::uint64_t{1} << 31;
inline constexpr std::uint64_t kMaxImageFileBytes = std::uint64_t{1} << 28;

/// Of a regular file of at most `max_bytes`.
Result<std::uint64_t> file_size(const std::filesystem::path& path, std::uint64_t max_bytes);
/// The whole of a regular file of at most `max_bytes`.
Result<Bytes> read_file(const std::filesystem::path& path, std::uint64_t max_bytes);

class SceneFolder {
 public:
  /// The folder that holds `scene_file`.
  explicit SceneFolder(std::filesystem::path scene_file);

  /// Where a decoded, relative URI points: inside the folder, whether or not anything is there.
  Result<std::filesystem::path> inside(const std::string& uri) const;
  /// The regular file it names.
  Result<std::filesystem::path> resolve(const std::string& uri) const;

 private:
  tl::unexpected<Error> refuse(const char* what, const std::string& uri) const;

  std::filesystem::path scene_file_, folder_;
};

/// "%20" and the like become the bytes they stand for; a broken escape stays as it is.
std::string percent_decoded(const std::string& uri);

}  // namespace macula::scene
