// Work that may crash, hang or swallow memory, done in a process of its own: parsers that nobody
// hardened against hostile files. The child has limits on memory and processor time, may write no
// file, and prints nothing; whatever becomes of it, the caller gets bytes or an Error. Not for
// processes that have threads at work in the same libraries (the child has only the calling one).
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "server/scene/files.h"
#include "shared/base/result.h"

namespace macula::scene::assimp {

struct Limits {
  std::uint64_t memory_bytes = 0;  ///< beyond what this process has now
  int cpu_s = 1;
  std::uint64_t answer_bytes = 0;
};

/// What `work` returned in the child. `place` names the input in errors.
Result<Bytes> run_isolated(const std::function<Bytes()>& work, const Limits& limits,
                           const std::string& place);

}  // namespace macula::scene::assimp
