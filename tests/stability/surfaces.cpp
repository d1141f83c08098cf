// Surfaces: geometry that is none, twice there or seen from behind, and materials at their ends.
#include <limits>

#include "tests/stability/extreme.h"

namespace macula::stability {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinite = std::numeric_limits<float>::infinity();

/// quiet_room() and one more triangle, of the ball's material.
Shot with_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  Shot shot = quiet_shot();
  scene::Mesh mesh;
  mesh.positions = {a, b, c};
  mesh.triangles = {{0, 1, 2}};
  mesh.material = 1;
  shot.scene.instances.push_back({static_cast<scene::Index>(shot.scene.meshes.size()), DMat4{1.0}});
  shot.scene.meshes.push_back(mesh);
  return shot;
}
Shot with_a_point() {
  return with_triangle(Vec3{0, 0, -2}, Vec3{0, 0, -2}, Vec3{0, 0, -2});
}
Shot with_a_line() {
  return with_triangle({-1, 0, -2}, {0, 0, -2}, {1, 0, -2});
}
Shot with_a_vertex_that_is_none() {
  return with_triangle({-1, 0, -2}, {kNan, 0, -2}, {0, 1, -2});
}
Shot with_an_infinite_vertex() {
  return with_triangle({-1, 0, -2}, {kInfinite, 0, -2}, {0, 1, -2});
}
Shot with_a_triangle() {
  return with_triangle({-0.2F, 0, -2}, {0.2F, 0, -2}, {0, 0.3F, -2});
}
Shot with_a_line_that_glows() {
  Shot shot = with_a_line();
  shot.scene.meshes.back().material = 2;
  return shot;
}
Shot with_a_triangle_that_glows() {
  Shot shot = with_a_triangle();
  shot.scene.meshes.back().material = 2;
  return shot;
}

Shot with_empty_meshes() {
  Shot shot = quiet_shot();
  for (int i = 0; i < 3; ++i) {
    shot.scene.instances.insert(shot.scene.instances.begin(),
                                {static_cast<scene::Index>(shot.scene.meshes.size()), DMat4{1.0}});
    shot.scene.meshes.emplace_back();
  }
  return shot;
}
Shot without_the_ball() {
  Shot shot = quiet_shot();
  shot.scene.meshes.pop_back(), shot.scene.instances.pop_back();
  return shot;
}

/// The floor a second time, where it is or above it.
Shot with_a_second_floor(float height) {
  Shot shot = quiet_shot();
  test::add_quad(shot.scene, {-2, -1 + height, 0.5F}, {4, 0, 0}, {0, 0, -4.5F}, 0);
  return shot;
}
Shot with_the_floor_twice() {
  return with_a_second_floor(0.0F);
}
Shot with_a_raised_floor() {
  return with_a_second_floor(0.02F);
}

/// The floor in strips a ten-thousandth as wide as long, or with one left out.
Shot floor_in_slivers(int left_out) {
  Shot shot = quiet_shot();
  scene::Mesh& floor = shot.scene.meshes.front();
  floor.positions.clear(), floor.texcoords.clear(), floor.triangles.clear();
  constexpr int kStrips = 10'000;
  const auto at = [](int i) { return -2.0F + 4.0F * static_cast<float>(i) / kStrips; };
  for (int i = 0; i <= kStrips; ++i) {
    floor.positions.emplace_back(at(i), -1.0F, 0.5F);
    floor.positions.emplace_back(at(i), -1.0F, -4.0F);
  }
  for (unsigned i = 0; i < kStrips; ++i) {
    if (static_cast<int>(i) / 100 == left_out) continue;
    floor.triangles.emplace_back(2 * i, 2 * i + 2, 2 * i + 3);
    floor.triangles.emplace_back(2 * i, 2 * i + 3, 2 * i + 1);
  }
  return shot;
}
Shot floor_in_whole_slivers() {
  return floor_in_slivers(-1);
}
Shot floor_with_a_slit() {
  return floor_in_slivers(50);
}

Shot two_sided() {
  Shot shot = quiet_shot();
  for (scene::Material& material : shot.scene.materials) material.double_sided = true;
  return shot;
}
Shot turned_inside_out() {
  Shot shot = two_sided();
  for (scene::Mesh& mesh : shot.scene.meshes)
    for (UVec3& triangle : mesh.triangles) std::swap(triangle.y, triangle.z);
  return shot;
}

/// Vertex normals of the floor.
Shot floor_normals(const Vec3& normal) {
  Shot shot = quiet_shot();
  scene::Mesh& floor = shot.scene.meshes.front();
  floor.normals.assign(floor.positions.size(), normal);
  return shot;
}
Shot normals_of_no_length() {
  return floor_normals(Vec3{0.0F});
}
Shot normals_that_are_none() {
  return floor_normals(Vec3{kNan});
}
Shot normals_that_lean() {
  return floor_normals(glm::normalize(Vec3{0.3F, 1.0F, 0.0F}));
}

/// The floor under a texture of one gray, with texture coordinates `uv` everywhere.
Shot textured_floor(const Vec2& uv, std::uint8_t gray) {
  Shot shot = quiet_shot();
  scene::Image image;
  image.pixels = image::Plane<image::Rgba8>(4, 4, image::Rgba8{gray, gray, gray, 255});
  shot.scene.images = {image};
  shot.scene.materials[0].base_color_texture = scene::TextureRef{};
  for (scene::Mesh& mesh : shot.scene.meshes) mesh.texcoords.assign(mesh.positions.size(), uv);
  return shot;
}
Shot gray_floor() {
  Shot shot = textured_floor({}, 128);
  for (scene::Mesh& mesh : shot.scene.meshes)
    if (mesh.positions.size() == 4) mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  return shot;
}
Shot gray_floor_without_uv_area() {
  return textured_floor(Vec2{0.3F}, 128);
}
Shot gray_floor_of_huge_uv() {
  Shot shot = textured_floor({}, 128);
  for (scene::Mesh& mesh : shot.scene.meshes)
    if (mesh.positions.size() == 4)
      mesh.texcoords = {{-1e30F, 1e30F}, {1e30F, 1e30F}, {1e30F, -1e30F}, {-1e30F, -1e30F}};
  return shot;
}
Shot gray_floor_of_uv_that_are_none() {
  return textured_floor(Vec2{kNan}, 128);
}
Shot lighter_floor() {
  return textured_floor(Vec2{0.3F}, 140);
}

/// A pane before everything.
Shot with_pane(scene::AlphaMode mode, float alpha, float cutoff) {
  Shot shot = quiet_shot();
  scene::Material pane = shot.scene.materials[0];
  pane.alpha_mode = mode, pane.alpha = alpha, pane.alpha_cutoff = cutoff;
  shot.scene.materials.push_back(pane);
  test::add_quad(shot.scene, {-0.5F, -0.5F, -1.2F}, {1, 0, 0}, {0, 1, 0}, 3);
  return shot;
}
Shot with_an_opaque_pane() {
  return with_pane(scene::AlphaMode::Opaque, 0.0F, 0.5F);
}
Shot with_a_mask_that_shows_all() {
  return with_pane(scene::AlphaMode::Mask, 0.0F, 0.0F);
}
Shot with_a_mask_that_hides_all() {
  return with_pane(scene::AlphaMode::Mask, 1.0F, 1.5F);
}
Shot with_a_blend_that_shows_all() {
  return with_pane(scene::AlphaMode::Blend, 1.0F, 0.5F);
}
Shot with_a_blend_that_hides_all() {
  return with_pane(scene::AlphaMode::Blend, 0.0F, 0.5F);
}

/// Everything a mirror-like metal, or as good as.
Shot of_metal(float roughness) {
  Shot shot = quiet_shot();
  for (scene::Material& material : shot.scene.materials) {
    material.metallic = 1.0F, material.specular = 1.0F;
    material.roughness = roughness;
  }
  return shot;
}
Shot of_polished_metal() {
  return of_metal(0.0F);
}
Shot of_nearly_polished_metal() {
  return of_metal(0.01F);
}
Shot of_rough_metal() {
  return of_metal(0.5F);
}

}  // namespace

std::vector<Extreme> surfaces() {
  return {
      {"ATriangleThatIsAPoint", quiet_shot, with_a_point, with_a_triangle},
      {"ATriangleThatIsALine", quiet_shot, with_a_line, with_a_triangle},
      {"ALineThatGlows", quiet_shot, with_a_line_that_glows, with_a_triangle_that_glows},
      {"AVertexThatIsNoNumber", quiet_shot, with_a_vertex_that_is_none, with_a_triangle},
      {"AVertexAtInfinity", quiet_shot, with_an_infinite_vertex, with_a_triangle},
      {"MeshesOfNothing", quiet_shot, with_empty_meshes, without_the_ball},
      {"TheFloorTwice", quiet_shot, with_the_floor_twice, with_a_raised_floor},
      {"TheFloorInSlivers", quiet_shot, floor_in_whole_slivers, floor_with_a_slit},
      {"EverythingInsideOut", two_sided, turned_inside_out, without_the_ball},
      {"NormalsOfNoLength", quiet_shot, normals_of_no_length, normals_that_lean},
      {"NormalsThatAreNoNumbers", quiet_shot, normals_that_are_none, normals_that_lean},
      {"UvWithoutArea", gray_floor, gray_floor_without_uv_area, lighter_floor},
      {"UvOfTenToTheThirty", gray_floor, gray_floor_of_huge_uv, lighter_floor},
      {"UvThatAreNoNumbers", gray_floor, gray_floor_of_uv_that_are_none, lighter_floor},
      {"AMaskThatShowsAll", with_an_opaque_pane, with_a_mask_that_shows_all, quiet_shot},
      {"AMaskThatHidesAll", quiet_shot, with_a_mask_that_hides_all, with_an_opaque_pane},
      {"ABlendThatShowsAll", with_an_opaque_pane, with_a_blend_that_shows_all, quiet_shot},
      {"ABlendThatHidesAll", quiet_shot, with_a_blend_that_hides_all, with_an_opaque_pane},
      {"RoughnessZero", of_nearly_polished_metal, of_polished_metal, of_rough_metal},
  };
}

}  // namespace macula::stability
