// What a kernel remembers of the last frames of one session. A camera cut is a new History.
// Kernels that keep something derive their own record from HistoryRecord and own it through here.
#pragma once

#include <memory>
#include <utility>

namespace macula::kernels {

struct HistoryRecord {
  virtual ~HistoryRecord() = default;
};

struct History {
  std::unique_ptr<HistoryRecord> record;
};

/// The record of a kernel that keeps a Record; a new one in the place of none, or of another
/// kernel's.
template <class Record>
Record& record_of(History& history) {
  if (auto* own = dynamic_cast<Record*>(history.record.get())) return *own;
  auto made = std::make_unique<Record>();
  Record& own = *made;
  history.record = std::move(made);
  return own;
}

}  // namespace macula::kernels
