// The header of a PLY file, checked before assimp reads it: assimp 5.2 looks for end_header beyond
// the end of the file without end, and makes room for as many elements as the header claims.
// Format: Greg Turk, "The PLY Polygon File Format", 1994.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "shared/base/result.h"

namespace macula::scene::assimp {

/// How far a header may reach.
inline constexpr std::size_t kMostPlyHeaderBytes = 65536;

/// `begin`: the file's first bytes, kMostPlyHeaderBytes or all of it. An Error names the line: what
/// is no PLY header, or claims more elements than the file has bytes.
Result<void> check_ply_header(std::string_view begin, std::uint64_t file_bytes,
                              const std::string& path);

}  // namespace macula::scene::assimp
