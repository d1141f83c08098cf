#include "tests/bench/ray_reference.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <span>

#include "server/kernels/registry.h"
#include "shared/base/text.h"
#include "shared/math/hash.h"

namespace macula::bench {
namespace {

/// Raise it when pictures change for a reason the hash cannot see: the renderer's own.
constexpr std::uint64_t kRendererVersion = 1;

class Hasher {
 public:
  template <class T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    add_bytes(&value, sizeof(T));
  }
  template <class T>
  void add_all(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add_bytes(values.data(), values.size_bytes());
  }
  std::uint64_t value() const { return value_; }

 private:
  void add_bytes(const void* data, std::size_t bytes) {
    const auto* at = static_cast<const char*>(data);
    for (std::size_t i = 0; i < bytes; i += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, at + i, std::min<std::size_t>(8, bytes - i));
      value_ = math::hash_combine(value_, word);
    }
    value_ = math::hash_combine(value_, bytes);
  }
  std::uint64_t value_ = kRendererVersion;
};

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

ReferenceBook::ReferenceBook(const RaySetting& setting, std::filesystem::path folder, int samples)
    : setting_(setting),
      folder_(folder.empty() ? default_folder() : std::move(folder)),
      samples_(samples),
      scene_hash_(hash_of(setting.scene->scene())) {}

HalfReferences ReferenceBook::at(const Pose& pose, scheduling::TileScheduler& scheduler) const {
  return {half(pose, 0x5EED'0001U, scheduler), half(pose, 0x5EED'0002U, scheduler)};
}

Plane<Rgb> ReferenceBook::half(const Pose& pose, std::uint64_t seed,
                               scheduling::TileScheduler& scheduler) const {
  const foveation::Display& display = setting_.display;
  Hasher hash;
  hash.add(scene_hash_), hash.add(pose.position), hash.add(pose.rotation), hash.add(seed);
  hash.add(display.width_px), hash.add(display.height_px), hash.add(samples_);
  hash.add(display.fov.left.value()), hash.add(display.fov.up.value());
  char name[32];
  std::snprintf(name, sizeof name, "%016llx.rgb", static_cast<unsigned long long>(hash.value()));
  Plane<Rgb> mean(display.width_px, display.height_px);
  if (read_plane(folder_ / name, mean)) return mean;

  // One light sample a primary sample: with this many of them, stratified together, they suffice.
  kernels::KernelOptions options;
  options.mode = kernels::Mode::Exact;
  options.samples_per_cell = samples_;
  options.area_light_samples = options.ambient_samples = 1;
  const auto kernel = kernels::make_kernel("ray", options);
  const kernels::View view{pose, foveation::make_uniform_grid(display), {}, {}};
  const FoveationMap map({{view.grid, view.gaze, display.pixel_tangent()}}, {});
  kernels::History history;
  kernels::FrameBuffers out;
  (*kernel)->render({{&view, 1}, map, 0, seed}, *setting_.scene, history, scheduler, out);
  mean = std::move(out.views.front().radiance);
  write_plane(folder_ / name, mean);
  return mean;
}

}  // namespace macula::bench
