#include "tests/bench/reprojection_methods.h"

#include <algorithm>
#include <array>

namespace macula::bench {
namespace {

using reprojection::WarpOptions;
using Silhouettes = WarpOptions::Silhouettes;
const std::array<Method, 10> kMethods{{
    {"stale", {.method = WarpOptions::Method::Stale}},
    {"rotation", {.method = WarpOptions::Method::RotationOnly}, false},
    {"rotation_guard", {.method = WarpOptions::Method::RotationOnly}},
    {"mesh", {.silhouettes = Silhouettes::Stretch}},
    {"mesh_cut", {.silhouettes = Silhouettes::Cut}},
    {"mesh_cut_splat", {}},
    {"grid", WarpOptions::grid_mode()},
    {"predicted", {}, true, true},
    {"layered", {}, true, false, true},
    {"layered_predicted", {}, true, true, true},
}};

}  // namespace

std::span<const Method> reprojection_methods() {
  return kMethods;
}

const Method& method_named(const std::string& name) {
  return *std::ranges::find(kMethods, name, &Method::name);
}

}  // namespace macula::bench
