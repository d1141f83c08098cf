// FolderIo: the only door through which assimp reaches files. Read-only, inside the scene's folder,
// whole files in memory. Remembers what it refused and what was not there.
#pragma once

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <optional>
#include <string>
#include <vector>

#include "server/scene/files.h"

namespace macula::scene::assimp {

class FolderIo final : public Assimp::IOSystem {
 public:
  explicit FolderIo(const SceneFolder& folder) : folder_(folder) {}

  bool Exists(const char* file) const override;
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char* mode) override;
  void Close(Assimp::IOStream* stream) override { delete stream; }

  /// The first file outside the folder or too large.
  const std::optional<Error>& refused() const { return refused_; }
  const std::vector<std::string>& missing() const { return missing_; }

 private:
  SceneFolder folder_;
  std::optional<Error> refused_;
  std::vector<std::string> missing_;
};

}  // namespace macula::scene::assimp
