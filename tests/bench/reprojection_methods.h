// The ways of hiding latency that `macula-bench reprojection` compares, each more than the one
// before.
#pragma once

#include <span>
#include <string>

#include "client/reprojection/warp.h"

namespace macula::bench {

struct Method {
  const char* name;
  reprojection::WarpOptions options;
  bool guarded = true, predicted = false, layered = false;
};
std::span<const Method> reprojection_methods();
/// One of them.
const Method& method_named(const std::string& name);

}  // namespace macula::bench
