#include "server/scene/assimp/import.h"

#include <cmath>
#include <fstream>

#include "server/scene/assimp/isolate.h"
#include "server/scene/assimp/make_scene.h"
#include "server/scene/assimp/ply_header.h"
#include "server/scene/assimp/reader.h"
#include "shared/base/text.h"

namespace macula::scene::assimp {
namespace {

/// Text formats take some ten times their size in assimp's hands; a small file gets a floor.
Limits limits_for(std::uint64_t file_bytes) {
  constexpr std::uint64_t kMegabyte = std::uint64_t{1} << 20;
  return {.memory_bytes = 192 * kMegabyte + 32 * file_bytes,
          .cpu_s = static_cast<int>(1 + file_bytes / kMegabyte),
          .answer_bytes = 64 * kMegabyte + 16 * file_bytes};
}

std::string first_bytes(const std::string& path, std::size_t most) {
  std::string bytes(most, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), static_cast<std::streamsize>(most));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

}  // namespace

bool reads(const std::string& path) {
  return find_format(path) != nullptr;
}

std::string list_of_suffixes() {
  std::string list;
  for (const Format& format : formats()) {
    list += base::concat(list.empty() ? "" : ", ", format.suffix);
  }
  return list;
}

Result<ImportedScene> import_file(const std::string& path) {
  const Format* format = find_format(path);
  if (format == nullptr) {
    return base::bad_input("unknown kind of file", path, "one of " + list_of_suffixes());
  }
  const auto size = file_size(path, kMaxSceneFileBytes);
  if (!size) return forward(size);
  if (format->suffix == ".ply") {
    const auto sound = check_ply_header(first_bytes(path, kMostPlyHeaderBytes), *size, path);
    if (!sound) return forward(sound);
  }
  const auto answer =
      run_isolated([&] { return encode(read_parcel(path, *format)); }, limits_for(*size), path);
  if (!answer) return forward(answer);
  Result<Parcel> parcel = decode(*answer, path);
  if (!parcel) return forward(parcel);
  const double unit = parcel->meters_per_unit;
  Result<Scene> scene = make_scene(path, std::move(*parcel));
  if (!scene) return forward(scene);
  const bool stated = std::isfinite(unit) && unit > 1e-9 && unit < 1e9;
  return ImportedScene{std::move(*scene), stated ? unit : 0.0};
}

}  // namespace macula::scene::assimp
