// Meshes and rays for the visibility tests, made from fixed seeds.
#pragma once

#include <map>

#include "server/sampling/mappings.h"
#include "server/sampling/sample.h"
#include "server/visibility/visibility.h"

namespace macula::visibility::test {

using sampling::sample;
using sampling::sample_2d;
using sampling::SampleKey;

/// A unit icosahedron, each face split into four `levels` times, vertices shared and moved along
/// their radius by up to +-`bump`. Closed; faces look outwards.
inline scene::Mesh make_bumpy_sphere(int levels, float bump) {
  const float g = 0.5F * (1.0F + std::sqrt(5.0F));
  scene::Mesh mesh;
  mesh.name = "bumpy sphere";
  for (const float s : {-1.0F, 1.0F}) {
    for (const float t : {-g, g}) {
      mesh.positions.insert(mesh.positions.end(), {{s, t, 0}, {0, s, t}, {t, 0, s}});
    }
  }
  // Faces: all triples of vertices at the edge length 2, turned outwards.
  const auto near = [&](unsigned a, unsigned b) {
    return std::abs(glm::distance(mesh.positions[a], mesh.positions[b]) - 2.0F) < 1e-3F;
  };
  for (unsigned a = 0; a < 12; ++a)
    for (unsigned b = a + 1; b < 12; ++b)
      for (unsigned c = b + 1; c < 12; ++c) {
        if (!near(a, b) || !near(b, c) || !near(a, c)) continue;
        const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
        const bool outwards = glm::dot(glm::cross(q - p, r - p), p) > 0.0F;
        mesh.triangles.push_back(outwards ? UVec3{a, b, c} : UVec3{a, c, b});
      }
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<unsigned, unsigned>, unsigned> middles;
    const auto middle = [&](unsigned a, unsigned b) {
      const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), mesh.positions.size());
      if (is_new) mesh.positions.push_back(0.5F * (mesh.positions[a] + mesh.positions[b]));
      return at->second;
    };
    std::vector<UVec3> finer;
    for (const UVec3& t : mesh.triangles) {
      const unsigned ab = middle(t.x, t.y), bc = middle(t.y, t.z), ca = middle(t.z, t.x);
      finer.insert(finer.end(), {{t.x, ab, ca}, {ab, t.y, bc}, {ca, bc, t.z}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const float radius = 1.0F + bump * (2.0F * sample(1, 0, i, 0) - 1.0F);
    mesh.positions[i] = radius * glm::normalize(mesh.positions[i]);
  }
  return mesh;
}

/// `count` triangles with an edge of some 0.5 m, anywhere in a cube of 2 m.
inline scene::Mesh make_triangle_soup(unsigned count) {
  scene::Mesh mesh;
  mesh.name = "soup";
  const auto anywhere = [](std::uint64_t i, std::uint32_t d) {
    const SampleKey key(2, 0, i);
    return 2.0F * Vec3{sample(key, d), sample(key, d + 1), sample(key, d + 2)} - 1.0F;
  };
  for (unsigned i = 0; i < count; ++i) {
    const Vec3 centre = anywhere(i, 0);
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
      mesh.positions.push_back(centre + 0.3F * anywhere(i, 3 + 3 * corner));
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

inline scene::Scene scene_of(scene::Mesh mesh, const std::vector<DMat4>& placed = {DMat4(1.0)}) {
  scene::Scene made;
  made.name = "test scene";
  made.materials.emplace_back();
  made.meshes.push_back(std::move(mesh));
  for (const DMat4& at : placed) made.instances.push_back({0, at});
  return made;
}

/// Rays from points within `spread` of the origin in all directions.
inline void fill_random_rays(RayStream& rays, std::uint64_t stream, float spread) {
  rays.clear();
  for (std::uint64_t i = 0; i < kStreamCapacity; ++i) {
    const SampleKey key(3, stream, i);
    const Vec3 origin =
        spread * (2.0F * Vec3{sample(key, 0), sample(key, 1), sample(key, 2)} - 1.0F);
    rays.push(origin, sampling::uniform_sphere(sample_2d(key, 3)), 0.0F,
              std::numeric_limits<float>::infinity());
  }
}

}  // namespace macula::visibility::test
