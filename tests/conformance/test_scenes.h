// Small scenes and one-call renders for the kernel conformance suite.
#pragma once

#include <cmath>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "server/kernels/registry.h"
#include "server/kernels/scene_frame.h"
#include "shared/foveation/foveation_map.h"

namespace macula::test {

/// Adds a parallelogram corner, corner + a, corner + b; its front is towards a x b.
inline void add_quad(scene::Scene& scene, const Vec3& corner, const Vec3& a, const Vec3& b,
                     scene::Index material) {
  scene::Mesh mesh;
  mesh.positions = {corner, corner + a, corner + a + b, corner + b};
  mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = material;
  scene.instances.push_back({static_cast<scene::Index>(scene.meshes.size()), DMat4{1.0}});
  scene.meshes.push_back(mesh);
}

/// A sphere of flat facets around `centre`, fronts outwards.
inline void add_sphere(scene::Scene& scene, const Vec3& centre, float radius, int rows,
                       scene::Index material) {
  constexpr float kPi = 3.14159265F;
  scene::Mesh mesh;
  const int columns = 2 * rows;
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const float t = kPi * static_cast<float>(r) / static_cast<float>(rows);
      const float p = kPi * static_cast<float>(c) / static_cast<float>(rows);
      mesh.positions.push_back(centre + radius * Vec3(std::sin(t) * std::cos(p), std::cos(t),
                                                      std::sin(t) * std::sin(p)));
    }
  }
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const auto at = [&](int row, int column) {
        return static_cast<scene::Index>(row * columns + column % columns);
      };
      mesh.triangles.emplace_back(at(r, c), at(r, c + 1), at(r + 1, c));
      mesh.triangles.emplace_back(at(r, c + 1), at(r + 1, c + 1), at(r + 1, c));
    }
  }
  mesh.material = material;
  scene.instances.push_back({static_cast<scene::Index>(scene.meshes.size()), DMat4{1.0}});
  scene.meshes.push_back(mesh);
}

/// A room open to the viewer at the origin looking down -Z: floor, wall, a glossy ball, lit by a
/// panel, a point light and an ambient term.
inline scene::Scene small_room() {
  scene::Scene scene;
  scene.name = "small room";
  scene.materials.resize(3);
  scene.materials[0].base_color = {0.7F, 0.6F, 0.5F};
  scene.materials[0].specular = 0.0F;
  scene.materials[1].base_color = {0.2F, 0.4F, 0.8F};
  scene.materials[1].roughness = 0.6F;
  scene.materials[2].emission = Rgb{6.0F, 5.0F, 4.0F};
  add_quad(scene, {-2, -1, 0.5F}, {4, 0, 0}, {0, 0, -4.5F}, 0);
  add_quad(scene, {-2, -1, -4}, {4, 0, 0}, {0, 3, 0}, 0);
  add_sphere(scene, {0.3F, -0.4F, -3}, 0.6F, 12, 1);
  add_quad(scene, {-0.7F, 1.5F, -3.2F}, {0.8F, 0, 0}, {0, 0, 0.8F}, 2);
  scene::Light light;
  light.intensity = Rgb{2.0F};
  light.position = {1.2, 0.8, -1.5};
  scene.lights = {light};
  scene.settings.ambient = Rgb{0.2F, 0.25F, 0.3F};
  scene.settings.ambient_distance_m = 2.0;
  return scene;
}

/// small_room() with walls on every side: every ray of any view meets a lit surface.
inline scene::Scene closed_room() {
  scene::Scene scene = small_room();
  add_quad(scene, {-2, -1, 0.5F}, {0, 0, -4.5F}, {0, 3, 0}, 0);
  add_quad(scene, {2, -1, 0.5F}, {0, 3, 0}, {0, 0, -4.5F}, 0);
  add_quad(scene, {-2, 2, 0.5F}, {0, 0, -4.5F}, {4, 0, 0}, 0);
  add_quad(scene, {-2, -1, 0.5F}, {0, 3, 0}, {4, 0, 0}, 0);
  return scene;
}

/// One convex white-ish ball in a uniform environment of radiance 1: every point sees all of it.
inline scene::Scene furnace(float albedo) {
  scene::Scene scene;
  scene.name = "furnace";
  scene.materials.resize(1);
  scene.materials[0].base_color = Rgb{albedo};
  scene.materials[0].specular = 0.0F;
  scene.settings.ambient = Rgb{1.0F};
  add_sphere(scene, {0, 0, -3}, 1.0F, 8, 0);
  return scene;
}

inline std::shared_ptr<const kernels::SceneFrame> frame_of(scene::Scene scene) {
  auto frame = kernels::SceneFrame::create(std::make_shared<const scene::Scene>(std::move(scene)));
  EXPECT_TRUE(frame) << (frame ? "" : frame.error().message());
  return *frame;
}

inline foveation::Display display(int side_px, double fov_degrees = 60.0) {
  return {math::symmetric_fov(Degrees{fov_degrees}, 1.0), side_px, side_px};
}

inline kernels::View view_on(const PixelGrid& grid) {
  kernels::View view;
  view.grid = grid;
  return view;
}

inline DVec3 mean(const image::Plane<Rgb>& picture) {
  DVec3 sum{0.0};
  for (const Rgb& value : picture.pixels()) sum += DVec3(value);
  return sum / static_cast<double>(picture.size());
}

struct Render {
  kernels::FrameBuffers buffers;
  kernels::FrameReport report;
  const kernels::ViewBuffers& planes() const { return buffers.views.front(); }
};

inline constexpr unsigned kAllPlanes = kernels::kSurfaceId | kernels::kNormal | kernels::kAlbedo |
                                       kernels::kRate | kernels::kVariance | kernels::kSamples;

/// Direct light alone unless `options` say otherwise: what all kernels have in common.
inline Render render(const std::string& kernel, kernels::KernelOptions options,
                     const kernels::SceneFrame& scene, const kernels::View& view,
                     kernels::TileScheduler& scheduler, std::uint64_t seed = 1) {
  options.bounces = options.bounces.value_or(0);
  const auto made = kernels::make_kernel(kernel, options);
  EXPECT_TRUE(made) << (made ? "" : made.error().message());
  const FoveationMap map({{view.grid, view.gaze, DVec2{1e-3}}}, foveation::RateModel{});
  Render result;
  result.buffers.wanted = kAllPlanes;
  kernels::History history;
  result.report =
      (*made)->render({{&view, 1}, map, 0, seed}, scene, history, scheduler, result.buffers);
  return result;
}

}  // namespace macula::test
