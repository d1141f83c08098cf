// The links of `macula-bench streaming`: what the proxy does to a connection, and when.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/chaos_proxy.h"

namespace macula::bench {

struct StreamingLink {
  std::string name;
  bool has_proxy = true;
  support::LinkShape shape;                    ///< both ways
  std::optional<support::LinkTrace> down, up;  ///< instead
  /// Nothing passes from this share of the run on, for `outage`.
  std::chrono::milliseconds outage{0};
  double outage_from = 0.5;
  /// From this share of the run on the link has this rate, until `slow_until`.
  double slow_bytes_per_s = 0.0, slow_from = 0.4, slow_until = 0.7;
};

/// Names of links that need no file.
std::vector<std::string> plain_link_names();
/// Errors: an unknown name, which lists them.
Result<StreamingLink> plain_link(const std::string& name);
/// One link a recording; `..._up.csv` belongs to its `..._down.csv`. Errors name the file.
Result<std::vector<StreamingLink>> recorded_links(const std::string& folder);

}  // namespace macula::bench
