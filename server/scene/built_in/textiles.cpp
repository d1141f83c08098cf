#include "server/scene/built_in/textiles.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/random.h"
#include "server/scene/built_in/shapes.h"

namespace macula::scene::built_in {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// A flat blade from `root`, bending towards `lean`.
void add_fibre(Mesh& mesh, const Vec3& root, const Vec3& lean, float length, float width,
               float turn) {
  const auto first = static_cast<Index>(mesh.positions.size());
  const Vec3 middle = root + Vec3{0.0F, 0.62F * length, 0.0F} + 0.35F * lean;
  const Vec3 tip = root + Vec3{0.0F, 0.92F * length, 0.0F} + lean;
  for (const auto& [centre, radius] : {std::pair{root, width}, std::pair{middle, 0.75F * width}}) {
    for (int k = 0; k < 2; ++k) {
      const float a = turn + kPi * static_cast<float>(k);
      const Vec3 out{std::cos(a), 0.0F, std::sin(a)};
      mesh.positions.push_back(centre + 0.5F * radius * out);
      mesh.normals.push_back(normalize(0.8F * out + Vec3{0.0F, 0.6F, 0.0F}));
    }
  }
  mesh.positions.push_back(tip);
  mesh.normals.push_back(normalize(lean + Vec3{0.0F, length, 0.0F}));
  mesh.texcoords.resize(mesh.positions.size(), Vec2{0.0F});
  for (UVec3 t : {UVec3{0, 1, 3}, UVec3{0, 3, 2}, UVec3{2, 3, 4}}) {
    t += UVec3(first);
    const Vec3 face =
        cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
    const Vec3 side = mesh.normals[t.x] + mesh.normals[t.y] + mesh.normals[t.z];
    if (dot(face, side) < 0.0F) std::swap(t.y, t.z);
    mesh.triangles.push_back(t);
  }
}

}  // namespace

Mesh pile_patch(const Pile& pile, std::uint64_t seed) {
  Dice dice(seed);
  Mesh mesh;
  mesh.name = "pile";
  const auto count = static_cast<std::size_t>(pile.fibres);
  mesh.positions.reserve(5 * count), mesh.normals.reserve(5 * count);
  mesh.texcoords.reserve(5 * count), mesh.triangles.reserve(3 * count);
  for (int i = 0; i < pile.fibres; ++i) {
    const Vec3 root{pile.side * (dice.next() - 0.5F), 0.0F, pile.side * (dice.next() - 0.5F)};
    // Neighbours lean alike: tufts.
    const float tuft = 3.0F * roughness(Vec3{18.0F, 0.0F, 18.0F} * root, seed);
    const float direction = tuft + 0.8F * dice.next();
    const float reach = pile.length * dice.in(0.25F, 0.8F);
    add_fibre(mesh, root, {reach * std::cos(direction), 0.0F, reach * std::sin(direction)},
              pile.length * dice.in(0.75F, 1.1F), pile.width, 2 * kPi * dice.next());
  }
  return mesh;
}

Mesh knitted_blanket(float width, float length, int columns, int rows) {
  const float stitch = width / static_cast<float>(columns),
              row_m = length / static_cast<float>(rows);
  const float yarn = 0.30F * stitch;
  const auto draped = [=](float x, float along, float off) {
    // Over a round edge of this radius; folds deepen on the way down.
    constexpr float kEdge = 0.06F;  // m
    const float fold = 0.02F * std::sin(9.0F * x) * std::max(0.0F, along);
    if (along < 0.0F) return Vec3{x, off, along};
    const float bend = std::min(along / kEdge, 0.5F * kPi);
    const float fall = std::max(0.0F, along - 0.5F * kPi * kEdge);
    return Vec3{x, (kEdge + off) * std::cos(bend) - kEdge - fall,
                (kEdge + off) * std::sin(bend) + fold};
  };
  Mesh mesh;
  mesh.name = "blanket";
  constexpr int kSteps = 12;
  for (int row = 0; row < rows; ++row) {
    std::vector<Vec3> path;
    for (int i = 0; i <= columns * kSteps; ++i) {
      // A row of stockinette loops (a planar cycloid-like curve that dips under its neighbours).
      const float t = static_cast<float>(i) / kSteps, phase = 2 * kPi * t;
      const float x = stitch * (t + 0.24F * std::sin(2.0F * phase)) - 0.5F * width;
      const float along =
          row_m * (static_cast<float>(row) + 0.72F * -std::cos(phase)) - 0.5F * length;
      path.push_back(draped(x, along, yarn * (1.2F + 0.8F * std::cos(2.0F * phase))));
    }
    append(mesh, tube("", path, yarn, 5, {1.0F, 1.0F}));
  }
  return mesh;
}

Mesh wicker_basket(float radius, float height) {
  constexpr int kStakes = 25;  // odd, so that every round runs before what the last ran behind
  const auto belly = [=](float v) {
    return radius * (0.78F + 0.30F * std::sin(0.62F * kPi * v + 0.3F));
  };
  Mesh mesh;
  mesh.name = "basket";
  for (int i = 0; i < kStakes; ++i) {
    const float a = 2 * kPi * static_cast<float>(i) / kStakes;
    std::vector<Vec3> stake;
    for (int k = 0; k <= 10; ++k) {
      const float v = static_cast<float>(k) / 10.0F;
      stake.emplace_back(belly(v) * std::cos(a), height * v, belly(v) * std::sin(a));
    }
    append(mesh, tube("", stake, 0.006F, 6));
  }
  const int rounds = static_cast<int>(height / 0.011F);
  std::vector<Vec3> weave;
  constexpr int kSteps = 100;
  for (int i = 0; i <= rounds * kSteps; ++i) {
    const float turns = static_cast<float>(i) / kSteps, a = 2 * kPi * turns;
    const float v = turns / static_cast<float>(rounds);
    const float r = belly(v) + 0.008F * std::sin(0.5F * kStakes * a);
    weave.emplace_back(r * std::cos(a), height * v, r * std::sin(a));
  }
  append(mesh, tube("", weave, 0.0065F, 6));
  append(mesh, torus("", belly(1.0F), 0.014F, 96, 8), translation({0.0, double{height}, 0.0}));
  return mesh;
}

Mesh cushion(const Vec3& half_size, int columns, int rows) {
  const auto bent = [](float t, float power) {
    return std::copysign(std::pow(std::abs(t), power), t);
  };
  const auto surface = [&](float u, float v) {
    const float azimuth = 2 * kPi * u, polar = kPi * v;
    const float ring = v <= 0.0F || v >= 1.0F ? 0.0F : bent(std::sin(polar), 0.42F);
    const float c = bent(std::cos(azimuth), 0.55F), s = bent(std::sin(azimuth), 0.55F);
    // Wrinkles run from the corners.
    const float wrinkle = 1.0F + 0.025F * std::sin(13.0F * azimuth) * ring * ring;
    return half_size * Vec3{ring * c, -std::cos(polar) * wrinkle, -ring * s};
  };
  Mesh mesh = tessellate("cushion", surface, {columns, rows, Around::Closed, {2.0F, 1.0F}});
  std::vector<Vec3> seam;
  for (int i = 0; i <= 96; ++i) {
    const float a = 2 * kPi * static_cast<float>(i) / 96.0F;
    seam.push_back(half_size * Vec3{1.004F * bent(std::cos(a), 0.55F), 0.0F,
                                    -1.004F * bent(std::sin(a), 0.55F)});
  }
  append(mesh, tube("", seam, 0.006F, 6));
  return mesh;
}

}  // namespace macula::scene::built_in
