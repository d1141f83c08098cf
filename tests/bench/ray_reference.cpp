#include "tests/bench/ray_reference.h"

#include <utility>

#include "server/kernels/ray/ray_kernel.h"

namespace macula::bench {

ReferenceBook::ReferenceBook(const RaySetting& setting, std::filesystem::path folder, int samples)
    : setting_(setting),
      cache_(std::move(folder)),
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
  if (setting_.materials != shading::MaterialModel::AsInScene) hash.add(setting_.materials);
  return cache_.at(hash.value(), display.width_px, display.height_px,
                   [&] { return rendered(pose, seed, scheduler); });
}

Plane<Rgb> ReferenceBook::rendered(const Pose& pose, std::uint64_t seed,
                                   scheduling::TileScheduler& scheduler) const {
  const foveation::Display& display = setting_.display;
  // One light sample a primary sample: with this many of them, stratified together, they suffice.
  kernels::ray::Config config;
  config.mode = kernels::Mode::Exact;
  config.samples_per_cell = samples_;
  config.area_light_samples = config.ambient_samples = 1;
  config.materials = setting_.materials;
  const kernels::ray::RayKernel kernel(config);
  const kernels::View view{pose, foveation::make_uniform_grid(display), {}, {}};
  const FoveationMap map({{view.grid, view.gaze, display.pixel_tangent()}}, {});
  kernels::History history;
  kernels::FrameBuffers out;
  kernel.render({{&view, 1}, map, 0, seed}, *setting_.scene, history, scheduler, out);
  return std::move(out.views.front().radiance);
}

}  // namespace macula::bench
