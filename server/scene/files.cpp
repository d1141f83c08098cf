#include "server/scene/files.h"

#include <algorithm>
#include <charconv>
#include <fstream>

#include "shared/base/text.h"

namespace macula::scene {
namespace fs = std::filesystem;

Result<std::uint64_t> file_size(const fs::path& path, std::uint64_t max_bytes) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    return base::bad_input("no such file", path.string(), "check the path and its spelling");
  }
  if (!fs::is_regular_file(status)) {
    return base::bad_input("not a regular file", path.string(),
                           "name a file, not a folder or device");
  }
  const std::uint64_t size = fs::file_size(path, error);
  if (error || size > max_bytes) {
    return base::bad_input(base::concat("the file has ", size, " bytes"), path.string(),
                           base::concat("at most ", max_bytes, " are read"));
  }
  return size;
}

Result<Bytes> read_file(const fs::path& path, std::uint64_t max_bytes) {
  const auto size = file_size(path, max_bytes);
  if (!size) return forward(size);
  std::ifstream stream(path, std::ios::binary);
  Bytes bytes(*size);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(*size));
  if (!stream)
    return base::bad_input("cannot read the file", path.string(), "check its permissions");
  return bytes;
}

SceneFolder::SceneFolder(fs::path scene_file) : scene_file_(std::move(scene_file)) {
  std::error_code error;
  folder_ = fs::weakly_canonical(fs::absolute(scene_file_, error).parent_path(), error);
}

tl::unexpected<Error> SceneFolder::refuse(const char* what, const std::string& uri) const {
  return base::bad_input(base::concat(what, " '", uri.substr(0, 200), "'"), scene_file_.string(),
                         "files of a scene lie inside its own folder, by relative path");
}

Result<fs::path> SceneFolder::inside(const std::string& uri) const {
  const bool odd = uri.empty() || uri.find('\0') != std::string::npos;
  if (odd || fs::path(uri).is_absolute() || uri.find("://") != std::string::npos) {
    return refuse("cannot use the path", uri);
  }
  std::error_code error;
  const fs::path target = fs::weakly_canonical(folder_ / uri, error);
  if (error) return refuse("cannot resolve the path", uri);
  const auto [end, unused] =
      std::mismatch(folder_.begin(), folder_.end(), target.begin(), target.end());
  if (end != folder_.end()) return refuse("the path leaves the scene's folder:", uri);
  return target;
}

Result<fs::path> SceneFolder::resolve(const std::string& uri) const {
  auto target = inside(uri);
  std::error_code error;
  if (target && !fs::is_regular_file(*target, error)) return refuse("no such file", uri);
  return target;
}

std::string percent_decoded(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned value = 0;
    const char* digits = uri.data() + i + 1;
    if (uri[i] == '%' && i + 2 < uri.size() &&
        std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
      text.push_back(static_cast<char>(value));
      i += 2;
    } else {
      text.push_back(uri[i]);
    }
  }
  return text;
}

}  // namespace macula::scene
