#include "tests/bench/primitive_scenes.h"

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "server/scene/field_scene.h"
#include "server/sdf/read.h"
#include "shared/base/check.h"
#include "shared/base/text.h"
#include "shared/math/hash.h"

namespace macula::bench {
namespace {

constexpr std::string_view kPrefix = "primitives-";
constexpr int kMostPrimitives = 20000;
constexpr double kDisc_m = 4.0, kDepth_m = 0.5;
/// Radius of a primitive for a disc of radius 1 that it has alone: seeds of a sunflower lie 1.7
/// radii apart or more.
constexpr double kShare = 0.8;

/// Kinds whose silhouettes at radius r cover about as much as a ball's.
std::string primitive(int kind, double r) {
  const auto numbers = [](std::string_view type, auto... parts) {
    return base::concat(R"("type": ")", type, R"(", )", parts...);
  };
  switch (kind) {
    case 0:
      return numbers("sphere", R"("radius": )", 0.94 * r);
    case 1:
      return numbers("box", R"("half_size": )", 0.82 * r, R"(, "edge_radius": )", 0.1 * r);
    case 2:
      return numbers("torus", R"("radius": )", 0.75 * r, R"(, "tube_radius": )", 0.4 * r);
    case 3:
      return numbers("cylinder", R"("radius": )", 0.88 * r, R"(, "half_height": )", 0.88 * r);
    case 4:
      return numbers("octahedron", R"("radius": )", 1.35 * r);
    default:
      return numbers("cone", R"("bottom_radius": )", 1.1 * r, R"(, "top_radius": )", 0.4 * r,
                     R"(, "half_height": )", 0.95 * r);
  }
}

constexpr std::array<std::string_view, 5> kMaterials{"red", "gold", "green", "blue", "ivory"};

std::string node(int i, int count) {
  const auto random = [i](int dimension) {
    return static_cast<double>(math::unit_float(math::hash_combine(i, dimension)));
  };
  const double radius = kDisc_m * std::sqrt((i + 0.5) / count);
  const double angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double depth = count == 1 ? 0.0 : kDepth_m * (2.0 * random(1) - 1.0);
  return base::concat("{", primitive(i % 6, kShare * kDisc_m / std::sqrt(count)), R"(, "at": [)",
                      count == 1 ? 0.0 : radius * std::cos(angle), ", ",
                      count == 1 ? 0.0 : radius * std::sin(angle), ", ", depth,
                      R"(], "rotate_deg": [)", 360.0 * random(2), ", ", 360.0 * random(3),
                      R"(, 0], "material": ")", kMaterials[static_cast<std::size_t>(i) % 5],
                      R"("})");
}

}  // namespace

std::optional<int> primitive_count(std::string_view name) {
  if (!name.starts_with(kPrefix)) return std::nullopt;
  const std::string_view digits = name.substr(kPrefix.size());
  int count = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), count);
  const bool whole = error == std::errc{} && end == digits.data() + digits.size();
  if (!whole || count < 1 || count > kMostPrimitives) return std::nullopt;
  return count;
}

std::string primitive_scene_text(int count) {
  std::string nodes;
  for (int i = 0; i < count; ++i) nodes += (i > 0 ? ",\n" : "") + node(i, count);
  return base::concat(R"({"sky": [0.45, 0.62, 0.9], "far": 100,
"materials": {"red": {"color": [0.7, 0.12, 0.1]}, "gold": {"color": [0.85, 0.6, 0.2]},
  "green": {"color": [0.16, 0.5, 0.2]}, "blue": {"color": [0.12, 0.26, 0.65]},
  "ivory": {"color": [0.8, 0.76, 0.66]}},
"suns": [{"direction": [-0.5, -0.6, -0.6], "irradiance": [2.6, 2.4, 2.1]}],
"cameras": [{"name": "front", "eye": [0, 0, 6], "target": [0, 0, 0], "vertical_fov_deg": 70}],
"scene": {"type": "union", "of": [
)",
                      nodes, "]}}\n");
}

std::shared_ptr<const scene::Scene> primitive_scene(int count) {
  auto field = sdf::parse_field(primitive_scene_text(count), base::concat(kPrefix, count));
  MACULA_CHECK(field.has_value(), "a scene made here is well formed");
  return std::make_shared<const scene::Scene>(
      scene::scene_of(std::make_shared<const sdf::Field>(std::move(*field))));
}

}  // namespace macula::bench
