// bistro_interior under its 41,753 emissive triangles against an outside renderer's picture.
//
// The handed pictures were rendered with the file's centimeters taken as meters, and are 6.5 %
// (camera A) and 1 % (camera B) too dark for it. Three pictures of the same renderer, Blender 3.4.1
// Cycles, show this, at camera A: as handed, 0.0936 0.1893 0.1458 (mean linear RGB, 64 samples a
// pixel); the scene scaled by 0.01, 0.1021 0.2038 0.1544 (512 samples); in centimeters, but with
// emission found by reflected rays alone ("sample as light" off), 0.1018 0.2035 0.1544 (1024).
// How it chooses points on small triangles depends on the unit. What stands below are the two
// pictures at scale 0.01, seeds 1 and 2, as luminance of 8 x 8 blocks; for the rest they follow the
// definition in direct_reference.json.
#include <array>

#include "server/exr/exr.h"
#include "server/scene/load.h"
#include "tests/conformance/test_scenes.h"
#include "tests/support/handed_data.h"

namespace macula {
namespace {

using Blocks = std::array<double, 64>;  ///< rows from the top

constexpr DVec3 kMeanA{0.102147, 0.203768, 0.154413};
constexpr Blocks kBlocksA{
    0.11527, 0.11667, 0.10464, 0.07894, 0.07970, 0.14068, 0.12262, 0.06637, 0.05635, 0.10061,
    0.13001, 0.09554, 0.10527, 0.11759, 0.04893, 0.02511, 0.07309, 0.08072, 0.05187, 0.04684,
    0.05046, 0.11729, 0.07741, 0.03540, 0.21787, 0.16147, 0.22822, 0.12319, 0.20324, 0.29180,
    0.13269, 0.01413, 0.27114, 0.29008, 0.28574, 0.19676, 0.23360, 0.21705, 0.13671, 0.12840,
    0.23139, 0.21259, 0.23336, 0.17166, 0.27987, 0.33726, 0.35673, 0.31330, 0.22630, 0.17358,
    0.12040, 0.12197, 0.36913, 0.30380, 0.34307, 0.30069, 0.19198, 0.19898, 0.19238, 0.22206,
    0.32731, 0.38884, 0.38332, 0.26099,
};

constexpr DVec3 kMeanB{1.799815, 2.109186, 1.152129};
constexpr Blocks kBlocksB{
    0.10914,  0.12249, 0.58368, 1.61435, 1.29479, 0.70559, 0.56449, 38.85572, 0.14826, 0.14389,
    0.38992,  8.83426, 1.45169, 0.32444, 0.12192, 0.53608, 5.69639, 0.18982,  0.23067, 29.63567,
    12.55455, 2.36737, 0.52692, 3.00000, 4.06471, 2.74182, 0.99247, 0.19913,  0.15539, 0.28602,
    0.37284,  0.14682, 0.03792, 0.03510, 0.07305, 0.12852, 0.13514, 0.06538,  0.09390, 0.08156,
    0.11363,  0.17903, 0.22678, 0.18813, 0.21965, 0.26838, 0.27265, 0.20422,  0.19744, 0.22270,
    0.21157,  0.13517, 0.22205, 0.43889, 0.42921, 0.43117, 0.24516, 0.27520,  0.24225, 0.21210,
    0.26640,  0.48090, 0.51853, 0.54304,
};

struct Viewed {
  const char* handed;  ///< the picture whose unit is wrong
  scene::Camera camera;
  foveation::Display display;
  DVec3 mean;  ///< linear Rec.709
  Blocks blocks;
};

/// In a scene that is in meters by now.
scene::Camera camera_b() {
  constexpr double kMeters = 0.01;  // the numbers are those of direct_reference.json
  scene::Camera camera;
  camera.parent_from_view =
      math::look_at(kMeters * DVec3{150, 110, 50}, kMeters * DVec3{300, 80, -400}, {0, 1, 0});
  camera.vertical_fov = Degrees{65.0};
  return camera;
}

foveation::Display display_of(const scene::Camera& camera, int width_px, int height_px) {
  return {math::symmetric_fov(camera.vertical_fov, static_cast<double>(width_px) / height_px),
          width_px, height_px};
}

Blocks blocks_of(const image::Plane<Rgb>& picture) {
  Blocks means{};
  const int width = picture.width() / 8, height = picture.height() / 8;
  for (int y = 0; y < 8 * height; ++y) {
    for (int x = 0; x < 8 * width; ++x) {
      means[static_cast<std::size_t>(8 * (y / height) + x / width)] +=
          double{image::luminance(picture(x, y))} / (width * height);
    }
  }
  return means;
}

/// The largest |a / b - 1| of their channels.
double largest_deviation(const DVec3& a, const DVec3& b) {
  double largest = 0.0;
  for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(a[c] / b[c] - 1.0));
  return largest;
}

/// Root mean square over the blocks of a / b - 1.
double block_deviation(const Blocks& a, const Blocks& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(a[i] / b[i] - 1.0, 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

/// A picture of half the samples each, so that their difference tells the noise.
struct Halves {
  image::Plane<Rgb> first, second;

  DVec3 mean() const { return 0.5 * (test::mean(first) + test::mean(second)); }
  Blocks blocks() const {
    Blocks sum = blocks_of(first);
    const Blocks other = blocks_of(second);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = 0.5 * (sum[i] + other[i]);
    return sum;
  }
  /// Of the blocks' mean over both halves, as block_deviation.
  double noise() const { return 0.5 * block_deviation(blocks_of(first), blocks_of(second)); }
};

/// Who renders, with how many samples a cell in each half.
struct Renderer {
  const char* kernel;
  int samples;
};

Halves halves(const Renderer& renderer, const kernels::SceneFrame& frame, const Viewed& viewed) {
  kernels::View view = test::view_on(foveation::make_uniform_grid(viewed.display));
  view.world_from_view = viewed.camera.parent_from_view;
  kernels::KernelOptions options;
  options.mode = kernels::Mode::Exact;
  options.samples_per_cell = renderer.samples;
  options.area_light_samples = 4;
  options.lambert_only = true;
  kernels::TileScheduler scheduler;
  const auto half = [&](std::uint64_t seed) {
    return test::render(renderer.kernel, options, frame, view, scheduler, seed).planes().radiance;
  };
  return {half(1), half(2)};
}

class BistroReference : public testing::TestWithParam<Renderer> {};

TEST_P(BistroReference, AgreesInMeanAndBlockByBlockAndTheHandedPictureDoesNot) {
  MACULA_NEEDS_HANDED_DATA("scenes/bistro_interior/reference/direct_lambert_camA_256.exr");
  const auto folder = test::handed_data() / "scenes/bistro_interior";
  const auto loaded = scene::load_scene((folder / "bistro_interior.gltf").string());
  ASSERT_TRUE(loaded) << loaded.error().message();
  const auto frame = *kernels::SceneFrame::create(*loaded);
  const scene::Camera a = (*loaded)->cameras.front(), b = camera_b();
  for (const Viewed& viewed :
       {Viewed{"direct_lambert_camA_256.exr", a, display_of(a, 64, 64), kMeanA, kBlocksA},
        Viewed{"direct_lambert_camB_320x240.exr", b, display_of(b, 64, 48), kMeanB, kBlocksB}}) {
    const Halves own = halves(GetParam(), *frame, viewed);
    // A lamp's edge in a block is worth a percent: 64 cells across do not see it as 256 pixels do.
    const double allowed = std::hypot(0.02, 1.5 * own.noise());
    EXPECT_LT(largest_deviation(own.mean(), viewed.mean), 0.02) << viewed.handed;
    EXPECT_LT(block_deviation(own.blocks(), viewed.blocks), allowed) << viewed.handed;

    // Must-fail twin. Brute force draws all triangles alike, and its noise would hide this.
    const auto handed = exr::read((folder / "reference" / viewed.handed).string());
    ASSERT_TRUE(handed) << handed.error().message();
    if (GetParam().kernel == std::string("brute")) continue;
    EXPECT_GT(block_deviation(blocks_of(*handed), viewed.blocks), 2.0 * allowed);
  }
}
INSTANTIATE_TEST_SUITE_P(By, BistroReference,
                         testing::Values(Renderer{"ray", 192}, Renderer{"lightcuts", 48},
                                         Renderer{"brute", 384}),
                         [](const auto& by) { return std::string(by.param.kernel); });

}  // namespace
}  // namespace macula
