// FrameOrder: which frame is newer. Within an epoch frames count up; an epoch number says nothing
// by its size (the server draws it), so a new one is newer than all before, and one that was left
// never comes back. A value; one thread.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace macula::frames {

struct FrameId {
  std::uint32_t epoch = 0;
  std::uint64_t frame = 0;
  friend auto operator<=>(const FrameId&, const FrameId&) = default;
};

class FrameOrder {
 public:
  /// Takes `id` as the newest and says true; false, and nothing changes, when it is not newer.
  bool advance(FrameId id);
  std::optional<FrameId> newest() const { return newest_; }

 private:
  bool was_left(std::uint32_t epoch) const;

  std::optional<FrameId> newest_;
  std::vector<std::uint32_t> left_epochs_;
};

}  // namespace macula::frames
