// The Cornell box (Goral et al. 1984; dimensions of Cornell University's 1998 data, 552.8 x 548.8 x
// 559.2 mm) scaled to a room 2.4 m wide, so that a standing person sees it through its open side.
#include <array>

#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/cornell_box.h"
#include "server/scene/built_in/scenes.h"
#include "server/scene/built_in/shapes.h"

namespace macula::scene::built_in {
namespace {

constexpr float kMetersPerMillimeter = 2.4F / 552.8F;

/// From the data's frame (x leftwards, z away from the viewer, origin at the front right corner) to
/// ours (x to the right, -z away, origin on the floor at the middle of the open side).
Vec3 from_data(float x, float y, float z) {
  return kMetersPerMillimeter * Vec3{276.4F - x, y, -z};
}

Mesh quad(std::string name, const Vec3& a, const Vec3& b, const Vec3& d) {
  return parallelogram(std::move(name), a, b - a, d - a);
}

/// A block standing on four floor corners (x, z), counter-clockwise seen from above in our frame.
Mesh block(std::string name, const std::array<Vec2, 4>& floor, float height) {
  Mesh mesh;
  mesh.name = std::move(name);
  const auto at = [&floor](std::size_t i, float y) {
    return from_data(floor[i % 4].x, y, floor[i % 4].y);
  };
  for (std::size_t i = 0; i < 4; ++i) append(mesh, quad("", at(i, 0), at(i + 1, 0), at(i, height)));
  append(mesh, quad("", at(0, height), at(1, height), at(3, height)));
  return mesh;
}

}  // namespace

CornellMaterials add_cornell_room(SceneBuilder& builder) {
  const Index white = builder.add(lambert("white", {0.725F, 0.71F, 0.68F}));
  const Index red = builder.add(lambert("red", {0.63F, 0.065F, 0.05F}));
  const Index green = builder.add(lambert("green", {0.14F, 0.45F, 0.091F}));
  const Vec3 floor_left = from_data(552.8F, 0, 0), floor_right = from_data(0, 0, 0);
  const Vec3 back_left = from_data(552.8F, 0, 559.2F), back_right = from_data(0, 0, 559.2F);
  const Vec3 up{0.0F, kMetersPerMillimeter * 548.8F, 0.0F};
  builder.place(quad("floor", floor_left, floor_right, back_left), white);
  builder.place(quad("ceiling", back_left + up, back_right + up, floor_left + up), white);
  builder.place(quad("back wall", back_left, back_right, back_left + up), white);
  builder.place(quad("left wall", floor_left, back_left, floor_left + up), red);
  builder.place(quad("right wall", back_right, floor_right, back_right + up), green);
  return {white, red, green};
}

void add_cornell_blocks(SceneBuilder& builder, Index material) {
  builder.place(block("short block", {{{130, 65}, {82, 225}, {240, 272}, {290, 114}}}, 165),
                material);
  builder.place(block("tall block", {{{423, 247}, {265, 296}, {314, 456}, {472, 406}}}, 330),
                material);
}

Scene cornell(std::uint64_t) {
  SceneBuilder builder("cornell");
  const CornellMaterials materials = add_cornell_room(builder);
  add_cornell_blocks(builder, materials.white);
  const Index light = builder.add(lamp("light", {17.0F, 12.0F, 4.0F}));
  // 1 mm (of the data) below the ceiling, facing down.
  builder.place(quad("lamp", from_data(343, 547.8F, 332), from_data(213, 547.8F, 332),
                     from_data(343, 547.8F, 227)),
                light);

  Settings& settings = builder.settings();
  settings.scene_from_stage.position = {0.0, 0.0, 0.9};
  settings.tone = {.exposure_ev = 1.0F, .curve = image::ToneCurve::Filmic};
  // Stands in for the light between the walls, which direct lighting leaves out.
  settings.ambient = Rgb{0.08F, 0.06F, 0.04F};
  settings.ambient_distance_m = 1.0;
  builder.add(
      Camera{"front", math::look_at({0.0, 1.2, 3.4}, {0.0, 1.2, 0.0}, {0, 1, 0}), Degrees{39.0}});
  return std::move(builder).finish();
}

}  // namespace macula::scene::built_in
