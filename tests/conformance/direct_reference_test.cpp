// Direct light against an independent renderer's picture: Lambert, no bounce, box filter.
#include <algorithm>
#include <cmath>
#include <vector>

#include "server/scene/load.h"
#include "server/exr/exr.h"
#include "tests/conformance/test_scenes.h"
#include "tests/support/handed_data.h"

namespace macula {
namespace {

using image::Plane;

constexpr double kReferenceNoise = 0.000125;  // direct_reference.json: RMS of luminance below p99

double quantile(const Plane<Rgb>& picture, double q) {
  std::vector<float> values;
  for (const Rgb& value : picture.pixels()) values.push_back(image::luminance(value));
  const auto nth =
      values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size()));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// RMS luminance difference over the pixels whose luminance in `reference` is below `limit`.
double rms_below(const Plane<Rgb>& reference, const Plane<Rgb>& a, const Plane<Rgb>& b,
                 double limit, double gain = 1.0) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (image::luminance(reference.pixels()[i]) >= limit) continue;
    const double difference =
        gain * image::luminance(a.pixels()[i]) - image::luminance(b.pixels()[i]);
    sum += difference * difference;
    ++count;
  }
  return std::sqrt(sum / count);
}

DVec3 mean(const Plane<Rgb>& picture) {
  DVec3 sum{0.0};
  for (const Rgb& value : picture.pixels()) sum += DVec3(value);
  return sum / static_cast<double>(picture.size());
}

TEST(DirectReference, CornellBoxAgreesWithinItsNoise) {
  MACULA_NEEDS_HANDED_DATA("scenes/cornell_box/reference/direct_lambert_256.exr");
  const auto folder = test::handed_data() / "scenes" / "cornell_box";
  const auto loaded = scene::load_scene((folder / "cornell_box.gltf").string());
  ASSERT_TRUE(loaded) << loaded.error().message();
  const auto reference = exr::read((folder / "reference/direct_lambert_256.exr").string());
  ASSERT_TRUE(reference) << reference.error().message();
  const auto frame = kernels::SceneFrame::create(*loaded);
  ASSERT_TRUE(frame) << frame.error().message();

  const scene::Camera& camera = (*loaded)->cameras.front();
  kernels::View view = test::view_on(
      foveation::make_uniform_grid({math::symmetric_fov(camera.vertical_fov, 1.0), 256, 256}));
  view.world_from_view = camera.parent_from_view;
  kernels::KernelOptions options;
  options.mode = kernels::Mode::Exact;
  options.samples_per_cell = 36;
  options.area_light_samples = 4;
  options.lambert_only = true;
  kernels::TileScheduler scheduler;
  const auto a = test::render("ray", options, **frame, view, scheduler, 1);
  const auto b = test::render("ray", options, **frame, view, scheduler, 2);

  const DVec3 wanted = mean(*reference), got = mean(a.planes().radiance);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c] / wanted[c], 1.0, 0.01);
  const double limit = quantile(*reference, 0.99);
  const double own =
      rms_below(*reference, a.planes().radiance, b.planes().radiance, limit) / std::sqrt(2.0);
  const double allowed = 1.15 * std::sqrt(kReferenceNoise * kReferenceNoise + own * own);
  EXPECT_LE(rms_below(*reference, a.planes().radiance, *reference, limit), allowed);
  EXPECT_GT(rms_below(*reference, a.planes().radiance, *reference, limit, 1.05), allowed)
      << "a picture 5 % too bright must be seen";
}

}  // namespace
}  // namespace macula
