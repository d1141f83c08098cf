#include "tests/bench/picture_cache.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <utility>

namespace macula::bench {
namespace {

std::filesystem::path default_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME")) {
    return std::filesystem::path(cache) / "macula-bench";
  }
  const char* home = std::getenv("HOME");
  return std::filesystem::path(home != nullptr ? home : "/tmp") / ".cache" / "macula-bench";
}

bool read_plane(const std::filesystem::path& path, Plane<Rgb>& plane) {
  std::ifstream file(path, std::ios::binary);
  const auto bytes = static_cast<std::streamsize>(plane.size() * sizeof(Rgb));
  return file && file.read(reinterpret_cast<char*>(plane.data()), bytes) && file.gcount() == bytes;
}

/// Under another name first: a file that is there is whole.
void write_plane(const std::filesystem::path& path, const Plane<Rgb>& plane) {
  std::error_code ignored;
  std::filesystem::create_directories(path.parent_path(), ignored);
  const std::filesystem::path half = path.string() + ".part";
  {
    std::ofstream file(half, std::ios::binary);
    file.write(reinterpret_cast<const char*>(plane.data()),
               static_cast<std::streamsize>(plane.size() * sizeof(Rgb)));
    if (!file) return;
  }
  std::filesystem::rename(half, path, ignored);
}

}  // namespace

std::uint64_t hash_of(const scene::Scene& scene) {
  Hasher hash;
  for (const scene::Image& image : scene.images) hash.add_all(image.pixels.pixels());
  for (const scene::Material& m : scene.materials) {
    hash.add(m.base_color), hash.add(m.alpha), hash.add(m.metallic), hash.add(m.roughness);
    hash.add(m.specular), hash.add(m.specular_color), hash.add(m.emission);
    hash.add(m.alpha_mode), hash.add(m.alpha_cutoff);
    hash.add(m.base_color_texture ? m.base_color_texture->image : ~0U);
  }
  for (const scene::Mesh& mesh : scene.meshes) {
    hash.add_all(std::span(mesh.positions)), hash.add_all(std::span(mesh.normals));
    hash.add_all(std::span(mesh.texcoords)), hash.add_all(std::span(mesh.triangles));
    hash.add(mesh.material);
  }
  for (const scene::Instance& instance : scene.instances) {
    hash.add(instance.mesh), hash.add(instance.parent_from_object);
  }
  for (const scene::Light& light : scene.lights) {
    hash.add(light.kind), hash.add(light.intensity), hash.add(light.position);
  }
  hash.add(scene.settings.ambient), hash.add(scene.settings.ambient_distance_m);
  return hash.value();
}

PictureCache::PictureCache(std::filesystem::path folder)
    : folder_(folder.empty() ? default_folder() : std::move(folder)) {}

Plane<Rgb> PictureCache::at(std::uint64_t hash, int width_px, int height_px,
                            const std::function<Plane<Rgb>()>& make) const {
  char name[32];
  std::snprintf(name, sizeof name, "%016llx.rgb", static_cast<unsigned long long>(hash));
  Plane<Rgb> picture(width_px, height_px);
  if (read_plane(folder_ / name, picture)) return picture;
  picture = make();
  write_plane(folder_ / name, picture);
  return picture;
}

}  // namespace macula::bench
