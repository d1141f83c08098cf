// What a kernel remembers of the last frames of one session. A camera cut is a new History.
// Kernels that keep something derive their own record from HistoryRecord and own it through here.
#pragma once

#include <memory>

namespace macula::kernels {

struct HistoryRecord {
  virtual ~HistoryRecord() = default;
};

struct History {
  std::unique_ptr<HistoryRecord> record;
};

}  // namespace macula::kernels
