// Scene: what a file or a built-in generator says, validated, in meters, before any acceleration
// structure. Immutable once made. Indices between the tables are always in range (import checks
// them). Conventions (Y up, right-handed, counter-clockwise front faces) as in
// shared/math/frames.h.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/scene/motion.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"
#include "shared/image/png.h"
#include "shared/image/tone.h"
#include "shared/math/pose.h"

namespace macula::sdf {
struct Field;
}

namespace macula::scene {

enum class ColorSpace { Linear, Srgb };
struct Image {
  std::string name;
  image::Plane<image::Rgba8> pixels;
};

enum class Wrap { Repeat, Clamp, Mirror };
struct TextureRef {
  Index image = 0;
  ColorSpace space = ColorSpace::Srgb;
  Wrap wrap_u = Wrap::Repeat, wrap_v = Wrap::Repeat;
  Vec2 uv_offset{0.0F},
      uv_scale{1.0F};  ///< KHR_texture_transform: uv' = offset + R(rotation) scale uv
  float uv_rotation_rad = 0.0F;
};

enum class AlphaMode { Opaque, Mask, Blend };

/// How a procedural material changes over a surface; a function of the place in the world.
enum class PatternKind { Checker, Bricks, Stripes, Noise };
struct Pattern {
  PatternKind kind = PatternKind::Checker;
  Rgb second_color{0.0F};  ///< linear reflectance, [0, 1], where it replaces base_color
  float size_m = 1.0F;     ///< > 0: edge of a square, height of a brick or band, of noise a feature
};

/// glTF metallic-roughness. Factors multiply their textures.
struct Material {
  std::string name;
  Rgb base_color{1.0F};  ///< linear reflectance, [0, 1]
  float alpha = 1.0F;
  std::optional<TextureRef> base_color_texture;          ///< alpha in its fourth channel
  std::optional<Pattern> pattern;                        ///< surfaces without uv have it instead
  float metallic = 0.0F;                                 ///< [0, 1]
  float roughness = 1.0F;                                ///< perceptual, alpha = roughness^2
  std::optional<TextureRef> metallic_roughness_texture;  ///< G roughness, B metallic, linear
  float specular = 1.0F;  ///< KHR_materials_specular; 0 = pure Lambert
  Rgb specular_color{1.0F};
  std::optional<TextureRef> specular_texture;        ///< in its fourth channel, linear
  std::optional<TextureRef> specular_color_texture;  ///< sRGB
  Rgb emission{0.0F};                                ///< radiance in W/(sr m^2), front face only
  std::optional<TextureRef> emission_texture;
  AlphaMode alpha_mode = AlphaMode::Opaque;
  float alpha_cutoff = 0.5F;
  bool double_sided = false;

  bool emits() const { return emission.x > 0.0F || emission.y > 0.0F || emission.z > 0.0F; }
};

/// One primitive: triangles that share a material.
struct Mesh {
  std::string name;
  std::vector<Vec3> positions;   ///< meters, object space
  std::vector<Vec3> normals;     ///< unit, as many as positions, or empty: flat shading
  std::vector<Vec2> texcoords;   ///< as many as positions, or empty
  std::vector<UVec3> triangles;  ///< indices into positions, counter-clockwise seen from the front
  Index material = 0;
  Deformation deformation;  ///< the vertices over time; `positions` and `normals` are those at rest
};

/// The parent of an instance, a light or a camera is the joint it hangs from, or the world where it
/// has none. Where things are at a moment: pose_at (animation.h).
struct Instance {
  Index mesh = 0;
  DMat4 parent_from_object{1.0};  ///< affine, invertible, never mirrors: fronts stay fronts
  std::optional<Index> joint = std::nullopt;
};

enum class LightKind { Point, Spot, Directional };
struct Light {
  LightKind kind = LightKind::Point;
  Rgb intensity{1.0F};                ///< W/sr for Point and Spot; irradiance W/m^2 for Directional
  DVec3 position{0.0};                ///< in the parent, meters; unused for Directional
  Vec3 direction{0.0F, -1.0F, 0.0F};  ///< unit, the way light travels, in the parent
  Radians inner_cone{0.0}, outer_cone{Degrees{45.0}};  ///< Spot half-angles, glTF falloff
  std::optional<Index> joint =
      std::nullopt;  ///< carries position and direction; its scale changes no intensity
};

struct Camera {
  std::string name;
  Pose parent_from_view;
  Radians vertical_fov{Degrees{60.0}};
  std::optional<Index> joint = std::nullopt;
};

/// Light from beyond the scene: what a ray sees that meets nothing, and what shines from there on
/// every surface. A light like any other, which `Settings::ambient` is not.
struct Environment {
  /// W/(sr m^2), finite, >= 0; not empty. 1 x 1: the same everywhere. Else equirectangular, as seen
  /// from inside: the top row looks to +Y, the middle to -Z, columns run to the right (towards +X).
  image::Plane<Rgb> radiance{1, 1, Rgb{0.0F}};
  Radians yaw{0.0};    ///< turned to the left about +Y
  float scale = 1.0F;  ///< times radiance, >= 0

  bool is_constant() const { return radiance.width() == 1 && radiance.height() == 1; }
  Rgb mean() const;  ///< over the sphere, scaled
};

/// What the side file says, or what was guessed (`guesses` has a sentence for each guess).
struct Settings {
  double meters_per_unit = 1.0;
  Pose scene_from_stage;  ///< where the viewer's stage stands, already in meters
  /// Where the scene's origin lies in its file, meters: not 0 where the file's was too far away.
  DVec3 file_from_scene_m{0.0};
  image::Tone tone;
  /// Stands in for light that was reflected many times: radiance of a constant surrounding of which
  /// a point sees what nothing within ambient_distance_m hides. Rays that meet nothing see it only
  /// in a scene without an environment.
  Rgb ambient{0.0F};
  double ambient_distance_m =
      std::numeric_limits<double>::infinity();  ///< occluders beyond do not count
  std::vector<std::string> guesses;
};

/// Axis-aligned box in world meters; empty (minimum > maximum) for a scene without triangles.
struct Bounds {
  DVec3 minimum{std::numeric_limits<double>::infinity()};
  DVec3 maximum{-std::numeric_limits<double>::infinity()};

  bool empty() const { return minimum.x > maximum.x; }
  DVec3 size() const { return empty() ? DVec3{0.0} : maximum - minimum; }
  DVec3 centre() const { return empty() ? DVec3{0.0} : 0.5 * (minimum + maximum); }
  void include(const DVec3& point);
};

struct Scene {
  std::string name;
  std::vector<Image> images;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Joint> joints;  ///< parents before children
  std::vector<Instance> instances;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  std::optional<Environment> environment;
  Settings settings;
  std::shared_ptr<const sdf::Field> field;  ///< a distance field instead of meshes; or null
  std::vector<std::string> warnings;        ///< what the importer ignored or repaired

  std::size_t triangle_count() const;           ///< over instances
  std::size_t emissive_triangle_count() const;  ///< over instances
  std::size_t unique_triangle_count() const;    ///< over meshes: what lies in memory
  Bounds bounds(SceneTime time = {}) const;     ///< over instances' vertices at that moment
};

/// Counts of a scene in one line: triangles, emissive triangles, lights, materials, textures, size.
std::string describe(const Scene& scene);

}  // namespace macula::scene
