// What the thread sanitizer must be told about the scheduler: TBB is not instrumented, so the order
// it creates between a caller and its tiles is stated by hand. Empty in ordinary builds.
#pragma once

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

namespace macula::scheduling::tsan {

/// Everything before release(place) happens before what follows a later acquire(place).
inline void release([[maybe_unused]] void* place) {
#if defined(__SANITIZE_THREAD__)
  __tsan_release(place);
#endif
}
inline void acquire([[maybe_unused]] void* place) {
#if defined(__SANITIZE_THREAD__)
  __tsan_acquire(place);
#endif
}

}  // namespace macula::scheduling::tsan
