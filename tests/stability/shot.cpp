#include "tests/stability/shot.h"

#include <algorithm>
#include <cmath>

namespace macula::stability {
namespace {

kernels::KernelOptions options_of(kernels::Mode mode) {
  kernels::KernelOptions options;
  options.mode = mode;
  options.jitter = false;
  options.ambient_samples = 2;
  if (mode == kernels::Mode::Exact) {
    options.bounces = 0;
  } else {
    options.reuse = kernels::Reuse::EarlierFrames;
    options.light_share = kernels::LightShare::Perceived;
  }
  return options;
}

}  // namespace

Picture show(const std::string& kernel, kernels::Mode mode, const Shot& shot) {
  static kernels::TileScheduler scheduler(2);
  const auto scene = test::frame_of(shot.scene);
  const auto made = kernels::make_kernel(kernel, options_of(mode));
  EXPECT_TRUE(made) << (made ? "" : made.error().message());
  kernels::View view;
  view.world_from_view = shot.eye;
  view.grid = shot.grid, view.gaze = shot.gaze;
  view.tone.exposure_ev = -std::log2(shot.gain);
  const FoveationMap map({{view.grid, view.gaze, DVec2{0.036}}}, shot.rate);
  kernels::History history;
  kernels::FrameBuffers buffers;
  buffers.wanted = test::kAllPlanes;
  Picture picture;
  const std::uint64_t frames = mode == kernels::Mode::Exact ? 1 : 3;
  for (std::uint64_t i = 0; i < frames; ++i) {
    const kernels::FrameRequest request{{&view, 1}, map, shot.frame + i, shot.seed};
    const auto report = (*made)->render(request, *scene, history, scheduler, buffers);
    picture.non_finite_samples += report.non_finite_samples;
  }
  picture.radiance = buffers.views.front().radiance;
  picture.depth_m = buffers.views.front().depth_m;
  for (Rgb& value : picture.radiance.pixels()) value = value / shot.gain;
  for (float& depth : picture.depth_m.pixels())
    depth = static_cast<float>(static_cast<double>(depth) / shot.unit_m);
  return picture;
}

Difference difference(const Picture& wanted, const Picture& got, double depth_error) {
  EXPECT_EQ(wanted.radiance.size(), got.radiance.size());
  Difference result;
  const auto cells = static_cast<double>(wanted.radiance.size());
  double mean = 0.0;
  for (const Rgb& value : wanted.radiance.pixels()) mean += image::luminance(value) / cells;
  const double floor = std::max(1e-2 * mean * mean, 1e-12);
  for (std::size_t i = 0; i < wanted.radiance.size(); ++i) {
    const DVec3 a(wanted.radiance.pixels()[i]), b(got.radiance.pixels()[i]);
    const DVec3 d = (b - a) * (b - a) / (a * a + floor);
    result.relative_mse += (d.x + d.y + d.z) / (3.0 * cells);
    const double near = wanted.depth_m.pixels()[i], far = got.depth_m.pixels()[i];
    const bool same = near == far || std::abs(far - near) <= depth_error * std::abs(near);
    result.strange_depths += same ? 0.0 : 1.0 / cells;
    result.finite = result.finite && math::is_finite(got.radiance.pixels()[i]) && !std::isnan(far);
  }
  return result;
}

scene::Scene quiet_room() {
  scene::Scene room = test::small_room();
  room.settings.ambient = Rgb{0.0F};
  room.meshes.pop_back(), room.instances.pop_back();  // the panel
  scene::Light second = room.lights.front();
  second.position = {-1.4, 0.3, -2.2};
  second.intensity = Rgb{0.8F, 1.0F, 1.2F};
  room.lights.push_back(second);
  return room;
}

Shot quiet_shot() {
  Shot shot;
  shot.scene = quiet_room();
  shot.grid = foveation::make_uniform_grid(test::display(32));
  return shot;
}

scene::Scene glowing_box() {
  scene::Scene box;
  box.name = "glowing box";
  box.materials.resize(1);
  box.materials[0].base_color = Rgb{0.0F};
  box.materials[0].specular = 0.0F;
  box.materials[0].emission = Rgb{1.0F};
  const auto wall = [&](const Vec3& corner, const Vec3& a, const Vec3& b) {
    test::add_quad(box, corner, a, b, 0);
  };
  const Vec3 x{4, 0, 0}, y{0, 4, 0}, z{0, 0, 4};
  wall({-2, -2, -2}, x, y), wall({-2, -2, 2}, y, x);  // fronts inwards: towards a x b
  wall({-2, -2, -2}, z, x), wall({-2, 2, -2}, x, z);
  wall({-2, -2, -2}, y, z), wall({2, -2, -2}, z, y);
  return box;
}

scene::Scene moved(scene::Scene scene, const DVec3& offset) {
  for (scene::Instance& instance : scene.instances)
    instance.parent_from_object = glm::translate(DMat4{1.0}, offset) * instance.parent_from_object;
  for (scene::Light& light : scene.lights) light.position += offset;
  return scene;
}

scene::Scene scaled(scene::Scene scene, double factor) {
  for (scene::Instance& instance : scene.instances) {
    instance.parent_from_object =
        glm::scale(DMat4{1.0}, DVec3{factor}) * instance.parent_from_object;
  }
  const auto square = static_cast<float>(factor * factor);
  for (scene::Light& light : scene.lights) light.position *= factor, light.intensity *= square;
  scene.settings.ambient_distance_m *= factor;
  return scene;
}

}  // namespace macula::stability
