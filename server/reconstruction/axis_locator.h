// AxisLocator: continuous cell coordinates on one axis of a grid without a search, for loops over
// vectors. Exact on equal steps; elsewhere a table at a quarter of the smallest step, off by at
// most a sixteenth of a cell times the change of neighbouring steps. Immutable; safe from any
// thread.
#pragma once

#include <vector>

namespace macula::reconstruction {

class AxisLocator {
 public:
  /// `edges`: strictly increasing, at least two.
  explicit AxisLocator(const std::vector<float>& edges);

  /// Cell i's centre is i + 0.5; beyond the edges it runs on.
  float locate(float tangent) const;

  bool equal_steps() const { return table_.empty(); }
  /// locate(t) = (t - first) * per_tangent for equal steps, else the place in the table.
  float first() const { return first_; }
  float per_tangent() const { return per_tangent_; }
  /// Cell coordinate at every bucket's start, and one more.
  const std::vector<float>& table() const { return table_; }

 private:
  float first_, per_tangent_;
  std::vector<float> table_;
};

}  // namespace macula::reconstruction
