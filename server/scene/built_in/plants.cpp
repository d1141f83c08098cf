#include "server/scene/built_in/plants.h"

#include <array>
#include <cmath>
#include <numbers>

#include "server/scene/built_in/random.h"
#include "server/scene/built_in/shapes.h"

namespace macula::scene::built_in {
namespace {

constexpr float kTurn = 2.0F * std::numbers::pi_v<float>;

/// A tube that thins from `thick` to nothing along a path.
Mesh limb(const std::vector<Vec3>& path, float thick, int columns) {
  Mesh mesh = tube("", path, thick, columns, {1.0F, 3.0F});
  // A tube's vertices come in rows around the path's points.
  const std::size_t row = mesh.positions.size() / path.size();
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const std::size_t at = std::min(i / row, path.size() - 1);
    const float thinner =
        1.0F - 0.85F * static_cast<float>(at) / static_cast<float>(path.size() - 1);
    mesh.positions[i] = path[at] + thinner * (mesh.positions[i] - path[at]);
  }
  return mesh;
}

/// From `root` along `direction`, drooping or rising with its length, wandering a little.
std::vector<Vec3> branch_path(const Vec3& root, Vec3 direction, float length, Dice& dice) {
  constexpr int kSteps = 5;
  std::vector<Vec3> path{root};
  for (int i = 0; i < kSteps; ++i) {
    const Vec3 wander{dice.in(-0.22F, 0.22F), dice.in(-0.06F, 0.22F), dice.in(-0.22F, 0.22F)};
    direction = normalize(direction + wander);
    path.push_back(path.back() + length / kSteps * direction);
  }
  return path;
}

/// A sprig's card: keeled and bent, of two by three quads.
Mesh sprig(float length) {
  const auto surface = [length](float u, float v) {
    const float across = 0.42F * length * (2.0F * u - 1.0F);
    return Vec3{across, length * v, 0.25F * length * v * v + 0.35F * std::abs(across)};
  };
  return tessellate("", surface, {2, 3, Around::Open});
}

void add_sprigs(Mesh& leaves, const std::vector<Vec3>& path, const TreeShape& shape,
                const Mesh& card, Dice& dice) {
  for (int i = 0; i < shape.sprigs_per_branch; ++i) {
    // More of them towards the tip.
    const float along = std::sqrt(dice.in(0.04F, 1.0F)) * static_cast<float>(path.size() - 1);
    const auto k = std::min(static_cast<std::size_t>(along), path.size() - 2);
    const Vec3 at = glm::mix(path[k], path[k + 1], along - static_cast<float>(k));
    append(leaves, card,
           translation(DVec3(at)) * rotation_y(Degrees{360.0 * dice.next()}) *
               rotation_x(Degrees{25.0 + 95.0 * dice.next()}) *
               rotation_z(Degrees{50.0 * (dice.next() - 0.5)}) *
               scaling(DVec3{0.7 + 0.6 * dice.next()}));
  }
}

}  // namespace

Tree tree(const TreeShape& shape, std::uint64_t seed) {
  Dice dice(seed);
  Tree result;
  const float trunk_height = 0.82F * shape.height;
  std::vector<Vec3> trunk;
  for (int i = 0; i <= 9; ++i) {
    const float t = static_cast<float>(i) / 9.0F;
    const float sway = 0.035F * shape.height * t;
    trunk.emplace_back(sway * dice.in(-1.0F, 1.0F), trunk_height * t, sway * dice.in(-1.0F, 1.0F));
  }
  result.wood = limb(trunk, 0.028F * shape.height, 10);
  const Mesh card = sprig(shape.sprig_length);
  for (int i = 0; i < shape.branches; ++i) {
    const float t = (static_cast<float>(i) + 0.5F) / static_cast<float>(shape.branches);
    const float height = glm::mix(shape.bare_trunk, 0.97F * trunk_height, t);
    const auto below = static_cast<std::size_t>(9.0F * height / trunk_height);
    const float azimuth = kTurn * (0.382F * static_cast<float>(i) + 0.08F * dice.next());
    const float rise = glm::mix(0.25F, 1.6F, t * t);
    const Vec3 direction = normalize(Vec3{std::cos(azimuth), rise, std::sin(azimuth)});
    // Widest at a third of the crown.
    const float reach =
        0.36F * shape.height * (1.0F - 0.75F * std::abs(t - 0.3F)) * dice.in(0.8F, 1.1F);
    const auto path = branch_path({trunk[below].x, height, trunk[below].z}, direction, reach, dice);
    append(result.wood, limb(path, 0.010F * shape.height, 6));
    add_sprigs(result.leaves, path, shape, card, dice);
  }
  result.wood.name = "wood", result.leaves.name = "leaves";
  return result;
}

Material foliage_material(std::string name, Index image) {
  Material material = textured(std::move(name), image);
  // Cards count v upwards from the stem, pictures downwards from the top.
  material.base_color_texture->uv_offset = {0.0F, 1.0F};
  material.base_color_texture->uv_scale = {1.0F, -1.0F};
  material.base_color_texture->wrap_u = material.base_color_texture->wrap_v = Wrap::Clamp;
  material.alpha_mode = AlphaMode::Mask;
  material.double_sided = true;
  return material;
}

}  // namespace macula::scene::built_in
