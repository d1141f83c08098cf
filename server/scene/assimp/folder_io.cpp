#include "server/scene/assimp/folder_io.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

namespace macula::scene::assimp {
namespace {

class MemoryStream final : public Assimp::IOStream {
 public:
  explicit MemoryStream(Bytes bytes) : bytes_(std::move(bytes)) {}

  std::size_t Read(void* to, std::size_t size, std::size_t count) override {
    if (size == 0) return 0;
    const std::size_t whole = std::min(count, (bytes_.size() - at_) / size);
    if (whole > 0) std::memcpy(to, bytes_.data() + at_, whole * size);
    at_ += whole * size;
    return whole;
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    const std::size_t from = origin == aiOrigin_SET   ? 0
                             : origin == aiOrigin_CUR ? at_
                                                      : bytes_.size();
    const std::size_t target = from + offset;  // may wrap: a negative offset, or nonsense
    if (target > bytes_.size()) return aiReturn_FAILURE;
    at_ = target;
    return aiReturn_SUCCESS;
  }
  std::size_t Tell() const override { return at_; }
  std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  Bytes bytes_;
  std::size_t at_ = 0;
};

std::string with_forward_slashes(std::string path) {
  std::replace(path.begin(), path.end(), '\\', '/');
  return path;
}

}  // namespace

bool FolderIo::Exists(const char* file) const {
  return folder_.resolve(with_forward_slashes(file)).has_value();
}

Assimp::IOStream* FolderIo::Open(const char* file, const char* mode) {
  if (std::strchr(mode, 'w') != nullptr || std::strchr(mode, 'a') != nullptr) return nullptr;
  const auto inside = folder_.inside(with_forward_slashes(file));
  std::error_code error;
  if (inside && !std::filesystem::is_regular_file(*inside, error)) {
    missing_.emplace_back(file);
    return nullptr;
  }
  Result<Bytes> bytes = inside ? read_file(*inside, kMaxSceneFileBytes) : base::forward(inside);
  if (!bytes) {
    if (!refused_) refused_ = bytes.error();
    return nullptr;
  }
  return new MemoryStream(std::move(*bytes));
}

}  // namespace macula::scene::assimp
