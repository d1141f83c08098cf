// Memory that was freed, on its way back to the system.
#pragma once

namespace macula::base {

/// Gives whole pages that nobody uses back to the system. The allocator keeps them otherwise, and
/// what a session needed once stays resident for good. Takes milliseconds; any thread.
void return_free_memory();

}  // namespace macula::base
