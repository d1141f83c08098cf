// What assimp makes of a file, as a Parcel. Runs in a process of its own (isolate.h): assimp's
// parsers may crash on hostile input. Files reach it through FolderIo alone.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "server/scene/assimp/parcel.h"
#include "shared/base/result.h"

namespace macula::scene::assimp {

/// Whether a format's own materials are worth reading.
enum class Materials { FromFile, Plain };
struct Format {
  std::string_view suffix;  ///< lower case, with its dot
  Materials materials;
};
/// The visible table of formats; assimp's other importers are switched off.
std::span<const Format> formats();
/// The entry of a path's suffix, in any case; nullptr where there is none.
const Format* find_format(const std::string& path);

Result<Parcel> read_parcel(const std::string& path, const Format& format);

}  // namespace macula::scene::assimp
