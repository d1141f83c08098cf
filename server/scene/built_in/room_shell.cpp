#include "server/scene/built_in/room_shell.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/shapes.h"

namespace macula::scene::built_in {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kWindowWidth = 1.3F, kSill = 0.85F, kWindowTop = 2.35F;  // m

void add_wall(Mesh& walls, const Vec3& corner, const Vec3& along, float height) {
  const Vec2 repeat = Vec2{glm::length(along), height} / 1.2F;
  append(walls, parallelogram("", corner, along, {0, height, 0}, repeat));
}

/// Four bars and a cross in the depth of the wall, and a sill; `centre` on the wall's face.
void add_window_frame(Mesh& frames, const DVec3& centre) {
  constexpr float kHeight = kWindowTop - kSill;
  const auto bar = [&](const Vec3& size, const DVec3& at) {
    append(frames, box("", size), translation(centre + DVec3{0.06, 0.0, 0.0} + at));
  };
  for (const double side : {-1.0, 0.0, 1.0}) {
    bar({0.12F, kHeight, 0.05F}, {0.0, 0.0, side * (kWindowWidth / 2.0 - 0.025)});
    bar({0.12F, 0.05F, kWindowWidth}, {0.0, side * (kHeight / 2.0 - 0.025), 0.0});
  }
  bar({0.30F, 0.04F, kWindowWidth + 0.2F}, {-0.08, -kHeight / 2.0 - 0.02, 0.0});
}

/// The wall at +x: piers between windows, a parapet below and a lintel above them.
void add_window_wall(Shell& shell, const Vec3& size, int windows) {
  const float x = size.x / 2, z = size.z / 2;
  const float pitch = size.z / static_cast<float>(std::max(windows, 1));
  add_wall(shell.walls, {x, 0, -z}, {0, 0, 2 * z}, kSill);
  add_wall(shell.walls, {x, kWindowTop, -z}, {0, 0, 2 * z}, size.y - kWindowTop);
  const auto edge = [=](int i, float side) {
    return -z + pitch * (static_cast<float>(i) + 0.5F) + side * kWindowWidth / 2;
  };
  for (int i = 0; i <= windows; ++i) {
    const float from = i == 0 ? -z : edge(i - 1, 1.0F), to = i == windows ? z : edge(i, -1.0F);
    add_wall(shell.walls, {x, kSill, from}, {0, 0, to - from}, kWindowTop - kSill);
    if (i == windows) continue;
    append(shell.panes, parallelogram("", {x + 0.06F, kSill, to}, {0, 0, kWindowWidth},
                                      {0, kWindowTop - kSill, 0}));
    add_window_frame(shell.window_frames,
                     {double{x}, (kSill + kWindowTop) / 2.0, double{to} + kWindowWidth / 2.0});
  }
}

void add_ceiling(Mesh& ceiling, const Vec3& size) {
  const int across = static_cast<int>(std::lround(size.x / 0.9F));
  const int along = static_cast<int>(std::lround(size.z / 0.9F));
  const Vec2 cell{size.x / static_cast<float>(across), size.z / static_cast<float>(along)};
  const auto coffer = [&](float u, float v) {
    const float rim = std::min(cell.x * std::min(u, 1.0F - u), cell.y * std::min(v, 1.0F - v));
    const float step = 0.05F * std::clamp((rim - 0.06F) / 0.02F, 0.0F, 1.0F) +
                       0.04F * std::clamp((rim - 0.13F) / 0.05F, 0.0F, 1.0F);
    const float r = std::hypot(cell.x * (u - 0.5F), cell.y * (v - 0.5F));
    const float angle = std::atan2(v - 0.5F, u - 0.5F);
    const float petal = 0.12F + 0.03F * std::cos(8.0F * angle);
    const float rosette = 0.03F * std::max(0.0F, 1.0F - r / petal);
    return Vec3{cell.x * (u - 0.5F), size.y + step - rosette, cell.y * (v - 0.5F)};
  };
  const Mesh one = tessellate("", coffer, {36, 36, Around::Open, {1.0F, 1.0F}});
  for (int j = 0; j < along; ++j) {
    for (int i = 0; i < across; ++i)
      append(ceiling, one,
             translation({double{cell.x} * (i + 0.5 - across / 2.0), 0.0,
                          double{cell.y} * (j + 0.5 - along / 2.0)}));
  }
}

/// Skirting and cornice along one wall, whose face is z = 0 towards +z.
Mesh mouldings_along(float length, float height) {
  Mesh mesh;
  append(mesh, box("", {length, 0.14F, 0.03F}), translation({0.0, 0.07, 0.015}));
  append(mesh, box("", {length, 0.02F, 0.04F}), translation({0.0, 0.15, 0.02}));
  const auto cove = [length](float u, float v) {
    const float a = 0.5F * kPi * v;
    const float egg = 0.008F * std::abs(std::sin(kPi * length / 0.08F * u)) * std::sin(kPi * v);
    return Vec3{length * (u - 0.5F), -0.16F + (0.16F + egg) * std::sin(a),
                (0.16F + egg) * (1.0F - std::cos(a)) + 0.002F};
  };
  append(mesh, tessellate("", cove, {static_cast<int>(length / 0.02F), 6, Around::Open}),
         translation({0.0, double{height} + 0.01, 0.0}));
  return mesh;
}

}  // namespace

Shell room_shell(const Vec3& size, int windows) {
  const float x = size.x / 2, z = size.z / 2;
  Shell shell;
  append(shell.floor,
         parallelogram("", {-x, 0, z}, {2 * x, 0, 0}, {0, 0, -2 * z}, Vec2{size.x, size.z} / 1.6F));
  add_wall(shell.walls, {-x, 0, -z}, {2 * x, 0, 0}, size.y);
  add_wall(shell.walls, {x, 0, z}, {-2 * x, 0, 0}, size.y);
  add_wall(shell.walls, {-x, 0, z}, {0, 0, -2 * z}, size.y);
  add_window_wall(shell, size, windows);
  add_ceiling(shell.ceiling, size);
  for (int side = 0; side < 4; ++side) {
    const float length = side % 2 == 0 ? size.x : size.z, distance = side % 2 == 0 ? z : x;
    append(shell.mouldings, mouldings_along(length, size.y),
           rotation_y(Degrees{90.0 * side}) * translation({0.0, 0.0, -double{distance}}));
  }
  shell.walls.name = "walls", shell.floor.name = "floor", shell.ceiling.name = "ceiling";
  shell.mouldings.name = "mouldings", shell.window_frames.name = "window frames";
  shell.panes.name = "panes";
  return shell;
}

}  // namespace macula::scene::built_in
