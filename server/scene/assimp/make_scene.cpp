#include "server/scene/assimp/make_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "server/scene/decode_image.h"
#include "server/scene/placement.h"
#include "server/scene/warnings.h"
#include "shared/base/text.h"

namespace macula::scene::assimp {
namespace {

constexpr std::uint64_t kMaxTriangles = std::uint64_t{1} << 26;
constexpr float kLargest = 1e12F;  ///< radiance, W/(sr m^2), and intensity, W/sr

float within(float value, float low, float high) {
  return value >= low ? std::min(value, high) : low;  // NaN: low
}
Rgb within(const Rgb& value, float low, float high) {
  return {within(value.x, low, high), within(value.y, low, high), within(value.z, low, high)};
}

class SceneMaker {
 public:
  SceneMaker(const std::string& path, Parcel parcel)
      : path_(path), folder_(path), parcel_(std::move(parcel)), placement_(scene_) {}

  Result<Scene> make();

 private:
  Result<void> add_material(const ParcelMaterial& from);
  Result<std::optional<TextureRef>> add_texture(const ParcelTexture& from);
  Result<std::optional<TextureRef>> add_base_color(const ParcelMaterial& from);
  Result<const image::Plane<image::Rgba8>*> picture(const std::string& path);
  Index add_image(const std::string& name, image::Plane<image::Rgba8> pixels);
  Result<void> add_mesh(std::size_t index);
  Result<void> place(const ParcelInstance& from);
  Result<void> add_light(const ParcelLight& from);
  void add_camera(const ParcelCamera& from);

  const std::string& path_;
  SceneFolder folder_;
  Parcel parcel_;
  Scene scene_;
  Placement placement_;
  Warnings warnings_;
  std::map<std::string, image::Plane<image::Rgba8>> pictures_;  ///< decoded, by resolved path
  std::map<std::string, Index> images_;                         ///< by name
  ImageDecoder decoder_;
  std::uint64_t triangles_ = 0;
};

Result<Scene> SceneMaker::make() {
  scene_.name = std::filesystem::path(path_).stem().string();
  for (const ParcelMaterial& material : parcel_.materials) {
    if (const auto added = add_material(material); !added) return forward(added);
  }
  for (std::size_t i = 0; i < parcel_.meshes.size(); ++i) {
    if (const auto added = add_mesh(i); !added) return forward(added);
  }
  for (const ParcelInstance& instance : parcel_.instances) {
    if (const auto placed = place(instance); !placed) return forward(placed);
  }
  for (const ParcelLight& light : parcel_.lights) {
    if (const auto added = add_light(light); !added) return forward(added);
  }
  for (const ParcelCamera& camera : parcel_.cameras) add_camera(camera);
  if (scene_.triangle_count() == 0) {
    return base::bad_input("the scene shows no triangles", path_,
                           "it needs at least one surface of triangles or polygons");
  }
  scene_.warnings = std::move(parcel_.warnings);
  for (std::string& sentence : warnings_.sentences())
    scene_.warnings.push_back(std::move(sentence));
  return std::move(scene_);
}

Result<const image::Plane<image::Rgba8>*> SceneMaker::picture(const std::string& named) {
  std::string path = named;
  std::replace(path.begin(), path.end(), '\\', '/');
  const auto resolved = folder_.resolve(path);
  if (!resolved) return forward(resolved);
  if (const auto known = pictures_.find(resolved->string()); known != pictures_.end()) {
    return &known->second;
  }
  const auto bytes = read_file(*resolved, kMaxImageFileBytes);
  if (!bytes) return forward(bytes);
  auto pixels = decoder_.decode(*bytes, base::concat(path_, ": image ", path));
  if (!pixels) return forward(pixels);
  return &pictures_.emplace(resolved->string(), std::move(*pixels)).first->second;
}

Index SceneMaker::add_image(const std::string& name, image::Plane<image::Rgba8> pixels) {
  scene_.images.push_back({name, std::move(pixels)});
  return images_[name] = static_cast<Index>(scene_.images.size() - 1);
}

TextureRef reference_to(Index image, const ParcelTexture& from) {
  TextureRef reference;
  reference.image = image;
  reference.wrap_u = from.wrap_u <= 2 ? static_cast<Wrap>(from.wrap_u) : Wrap::Repeat;
  reference.wrap_v = from.wrap_v <= 2 ? static_cast<Wrap>(from.wrap_v) : Wrap::Repeat;
  return reference;
}

Result<std::optional<TextureRef>> SceneMaker::add_texture(const ParcelTexture& from) {
  if (from.path.empty()) return std::optional<TextureRef>{};
  const auto pixels = picture(from.path);
  if (!pixels) return forward(pixels);
  const auto known = images_.find(from.path);
  const Index index = known != images_.end() ? known->second : add_image(from.path, **pixels);
  return std::optional(reference_to(index, from));
}

/// How much is there at a texel of an opacity texture: its alpha where it has one, else its grey.
std::uint8_t presence(const image::Rgba8& texel) {
  if (texel.a != 255) return texel.a;
  return static_cast<std::uint8_t>((2 * texel.r + 5 * texel.g + texel.b) / 8);
}

/// The colours of one picture with the opacity of another of any size, nearest texel.
image::Plane<image::Rgba8> with_opacity(image::Plane<image::Rgba8> colors,
                                        const image::Plane<image::Rgba8>& opacity) {
  for (int y = 0; y < colors.height(); ++y) {
    for (int x = 0; x < colors.width(); ++x) {
      const auto scaled = [](int i, int from, int to) {
        return static_cast<int>(static_cast<std::int64_t>(i) * to / from);
      };
      colors(x, y).a = presence(opacity(scaled(x, colors.width(), opacity.width()),
                                        scaled(y, colors.height(), opacity.height())));
    }
  }
  return colors;
}

/// Opacity travels in the colour's fourth channel, so a texture of its own is merged into it.
Result<std::optional<TextureRef>> SceneMaker::add_base_color(const ParcelMaterial& from) {
  if (from.alpha.path.empty()) return add_texture(from.base_color);
  const auto opacity = picture(from.alpha.path);
  if (!opacity) return forward(opacity);
  image::Plane<image::Rgba8> colors((*opacity)->width(), (*opacity)->height(),
                                    image::Rgba8{255, 255, 255, 255});
  if (!from.base_color.path.empty()) {
    const auto given = picture(from.base_color.path);
    if (!given) return forward(given);
    colors = **given;
  }
  const std::string name = from.base_color.path + " with opacity " + from.alpha.path;
  const auto known = images_.find(name);
  const Index index = known != images_.end()
                          ? known->second
                          : add_image(name, with_opacity(std::move(colors), **opacity));
  return std::optional(
      reference_to(index, from.base_color.path.empty() ? from.alpha : from.base_color));
}

Result<void> SceneMaker::add_material(const ParcelMaterial& from) {
  const MaterialNumbers& numbers = from.numbers;
  Material to;
  to.name = from.name;
  to.base_color = within(numbers.base_color, 0.0F, 1.0F);
  to.alpha = within(numbers.alpha, 0.0F, 1.0F);
  to.metallic = within(numbers.metallic, 0.0F, 1.0F);
  to.roughness = within(numbers.roughness, 0.0F, 1.0F);
  to.specular = within(numbers.specular, 0.0F, 1.0F);
  to.specular_color = within(numbers.specular_color, 0.0F, kLargest);
  to.emission = within(numbers.emission, 0.0F, kLargest);
  if (to.base_color != numbers.base_color || to.emission != numbers.emission) {
    warnings_.add("material '" + to.name +
                  "': values out of range are taken as the nearest allowed");
  }
  to.double_sided = numbers.double_sided != 0;
  const auto base_color = add_base_color(from);
  if (!base_color) return forward(base_color);
  const auto emission = add_texture(from.emission);
  if (!emission) return forward(emission);
  to.base_color_texture = *base_color;
  to.emission_texture = *emission;
  if (!from.alpha.path.empty()) to.alpha_mode = AlphaMode::Mask;
  if (to.alpha < 1.0F) to.alpha_mode = AlphaMode::Blend;
  scene_.materials.push_back(std::move(to));
  return {};
}

bool all_finite(const std::vector<Vec3>& vectors) {
  return std::all_of(vectors.begin(), vectors.end(),
                     [](const Vec3& v) { return math::is_finite(v); });
}

/// Unit length; false when one has no direction.
bool normalize_all(std::vector<Vec3>& normals) {
  for (Vec3& normal : normals) {
    const double length = glm::length(DVec3(normal));
    if (!(length > 0.0) || !std::isfinite(length)) return false;
    normal = Vec3(DVec3(normal) / length);
  }
  return true;
}

Result<void> SceneMaker::add_mesh(std::size_t index) {
  ParcelMesh& from = parcel_.meshes[index];
  const std::string place =
      base::concat(path_, ": mesh ", index, " '", from.name.substr(0, 60), "'");
  const std::size_t vertices = from.positions.size();
  triangles_ += from.triangles.size();
  if (triangles_ > kMaxTriangles) {
    return base::bad_input("the scene has too many triangles", place,
                           base::concat("at most ", kMaxTriangles));
  }
  if (from.material >= scene_.materials.size()) {
    return base::bad_input(base::concat("there is no material ", from.material), place,
                           base::concat("there are ", scene_.materials.size()));
  }
  if (!all_finite(from.positions)) {
    return base::bad_input("a vertex is not finite", place,
                           "export again without NaN or infinite values");
  }
  for (const UVec3& t : from.triangles) {
    if (std::max({t.x, t.y, t.z}) >= vertices) {
      return base::bad_input(base::concat("an index is ", std::max({t.x, t.y, t.z})), place,
                             base::concat("there are ", vertices, " vertices"));
    }
  }
  if (from.normals.size() != vertices || !normalize_all(from.normals)) {
    if (!from.normals.empty()) warnings_.add("normals without direction: the mesh is shaded flat");
    from.normals.clear();
  }
  for (Vec2& uv : from.texcoords) {
    if (math::is_finite(Vec3{uv, 0.0F})) continue;
    uv = Vec2{0.0F};
    warnings_.add("texture coordinates that are not finite are taken as 0");
  }
  if (from.texcoords.size() != vertices) from.texcoords.clear();
  Mesh& to = scene_.meshes.emplace_back();
  to.name = std::move(from.name);
  to.positions = std::move(from.positions);
  to.normals = std::move(from.normals);
  to.texcoords = std::move(from.texcoords);
  to.triangles = std::move(from.triangles);
  to.material = from.material;
  return {};
}

Result<void> SceneMaker::place(const ParcelInstance& from) {
  if (from.mesh >= parcel_.meshes.size()) {
    return base::bad_input(base::concat("a node names mesh ", from.mesh), path_,
                           base::concat("there are ", parcel_.meshes.size()));
  }
  DMat4 transform = from.world_from_object;
  bool finite = true;
  for (int column = 0; column < 4; ++column) {
    finite = finite && math::is_finite(DVec3(transform[column]));
    transform[column].w = column == 3 ? 1.0 : 0.0;  // rounding of a product of affine matrices
  }
  if (!finite) {
    return base::bad_input("a node's transform is not finite", path_,
                           "finite, moderate scales and translations");
  }
  return placement_.place({from.mesh, transform}, path_);
}

Result<void> SceneMaker::add_light(const ParcelLight& from) {
  const double length = glm::length(from.direction);
  Light light;
  light.kind = static_cast<LightKind>(std::min(from.kind, 2U));
  light.intensity = within(from.intensity, 0.0F, kLargest);
  light.position = from.position;
  const bool aimed = light.kind == LightKind::Point || (length > 0.0 && std::isfinite(length));
  if (!math::is_finite(from.position) || !aimed) {
    return base::bad_input("a light's place or direction is not finite", path_,
                           "finite numbers and a direction that is not zero");
  }
  if (light.kind != LightKind::Point) light.direction = Vec3(from.direction / length);
  constexpr double kWidest = std::numbers::pi / 2.0;
  const double outer = from.outer_cone_rad > 0.0 ? std::min(from.outer_cone_rad, kWidest) : kWidest;
  const double inner = from.inner_cone_rad >= 0.0 ? from.inner_cone_rad : 0.0;
  light.outer_cone = Radians{outer};
  light.inner_cone = Radians{std::min(inner, 0.999 * outer)};  // a hard edge, but a cone
  scene_.lights.push_back(light);
  return {};
}

void SceneMaker::add_camera(const ParcelCamera& from) {
  const bool aimed = glm::length(glm::cross(from.direction, from.up)) > 0.0;
  const bool open = from.vertical_fov_rad > 0.0 && from.vertical_fov_rad < std::numbers::pi;
  Pose pose;
  if (aimed) pose = math::look_at(from.position, from.position + from.direction, from.up);
  if (!aimed || !open || !math::is_valid(pose)) {
    return warnings_.add("a camera without a view is ignored");
  }
  scene_.cameras.push_back({from.name, pose, Radians{from.vertical_fov_rad}});
}

}  // namespace

Result<Scene> make_scene(const std::string& path, Parcel parcel) {
  return SceneMaker(path, std::move(parcel)).make();
}

}  // namespace macula::scene::assimp
