#include "server/kernels/lightcuts/other_eye.h"

#include <cmath>
#include <cstring>

#include "server/kernels/lightcuts/lightcuts_kernel.h"
#include "server/kernels/planes.h"
#include "tests/conformance/test_scenes.h"

namespace macula::kernels::lightcuts {
namespace {

constexpr int kSide = 96;
constexpr float kBoardIs = 1.0F, kWallIs = 2.0F;  ///< light over reflectance

/// A wall at 3 m and, half a meter away, a board before its middle; a lamp behind the eyes.
std::shared_ptr<const SceneFrame> wall_behind_board(bool with_board, float wall_roughness = -1.0F) {
  scene::Scene scene;
  scene.materials.resize(2);
  scene.materials[0].base_color = {0.5F, 0.4F, 0.3F};
  scene.materials[0].specular = 0.0F;
  scene.materials[1] = scene.materials[0];
  if (wall_roughness >= 0.0F)
    scene.materials[1].specular = 1.0F, scene.materials[1].roughness = wall_roughness;
  macula::test::add_quad(scene, {-4, -4, -3}, {8, 0, 0}, {0, 8, 0}, 1);
  if (with_board)
    macula::test::add_quad(scene, {-0.2F, -0.2F, -0.5F}, {0.4F, 0, 0}, {0, 0.4F, 0}, 0);
  scene::Light lamp;
  lamp.position = {0.5, 1.0, 0.5};
  lamp.intensity = Rgb{3.0F};
  scene.lights = {lamp};
  scene.settings.ambient = Rgb{0.0F};
  return macula::test::frame_of(std::move(scene));
}

/// Two eyes with one gaze; the left one's cells may be `wider`.
struct Eyes {
  foveation::Display display = macula::test::display(kSide, 90.0);
  foveation::Display wide = macula::test::display(kSide / 4, 90.0);
  std::vector<View> views{2, macula::test::view_on(foveation::make_uniform_grid(display))};
  FoveationMap map;

  explicit Eyes(bool wider = false) : map(make(wider)) {}
  FoveationMap make(bool wider) {
    if (wider) views[0].grid = foveation::make_uniform_grid(wide);
    views[0].world_from_view.position.x -= 0.0315;
    views[1].world_from_view.position.x += 0.0315;
    std::vector<FoveationMap::ViewInput> inputs;
    for (const View& view : views)
      inputs.push_back({view.grid, view.gaze, display.pixel_tangent()});
    return {std::move(inputs), {}};
  }
  FrameRequest request(std::uint64_t frame = 0) const { return {views, map, frame, 3}; }
};

struct Seen {
  std::vector<ViewSurfaces> surfaces;
  Plane<Rgb> left_light;
};
bool is_board(const Vec3& position) {
  return position.z > -2.0F;
}

/// The left eye's light says what it shines on, over reflectance.
Seen seen_by(const Eyes& eyes, const SceneFrame& scene, TileScheduler& scheduler) {
  Seen seen;
  FrameBuffers out;
  prepare_buffers(eyes.views, out);
  KernelOptions options;
  options.jitter = false;
  trace_surfaces(eyes.request(), scene, make_config(options).ray, scheduler, seen.surfaces, out);
  const ViewSurfaces& left = seen.surfaces[0];
  seen.left_light.resize(left.width, left.height);
  for (int y = 0; y < left.height; ++y) {
    for (int x = 0; x < left.width; ++x) {
      if (const SurfaceAt at = left.at(x, y))
        seen.left_light(x, y) = (is_board(at.position()) ? kBoardIs : kWallIs) *
                                at.points->reflectors.reflectance[at.index];
    }
  }
  return seen;
}

/// Of the right eye's points: all, hidden from the left eye, with light taken over.
struct Count {
  int all = 0, hidden = 0, taken = 0, taken_hidden = 0, wrong = 0;
};
/// `scene`: what is there; the left eye has seen `seen`.
Count count(const Eyes& eyes, const SceneFrame& scene, const Seen& left, const Seen& right) {
  const OtherEye other(eyes.views[0], left.surfaces[0], left.left_light, eyes.views[1]);
  const Vec3 left_eye(eyes.views[0].world_from_view.position);
  Count count;
  for (const SurfaceTile& tile : right.surfaces[1].tiles) {
    for (std::size_t i = 0; i < tile.points.count; ++i) {
      const Vec3 from = tile.points.ray_origin[i];
      const bool hidden = scene.occluded({from, left_eye - from, 0.0F, 1.0F});
      const auto light = other.light(tile, i);
      ++count.all, count.hidden += hidden, count.taken += light.has_value();
      if (!light) continue;
      count.taken_hidden += hidden;
      const float own = tile.points.reflectors.reflectance[i].x;
      const float is = is_board(tile.points.position[i]) ? kBoardIs : kWallIs;
      count.wrong += std::abs(light->x / own - is) > 1e-5F * is;  // rounding of three products
    }
  }
  return count;
}

TEST(OtherEye, TakesLightOfTheSameSurfaceAlone) {
  TileScheduler scheduler(1);
  const Eyes eyes;
  const auto scene = wall_behind_board(true);
  const Seen seen = seen_by(eyes, *scene, scheduler);
  const Count found = count(eyes, *scene, seen, seen);
  EXPECT_EQ(found.wrong, 0) << "light of the board on the wall, or the other way round";
  EXPECT_GT(found.taken, found.all * 8 / 10);
  // The twin: a left eye that sees no board has light for what the board hides from it.
  const Count twin = count(eyes, *scene, seen_by(eyes, *wall_behind_board(false), scheduler), seen);
  EXPECT_GT(found.hidden, 50);
  EXPECT_LT(found.taken_hidden, found.hidden / 4) << "within a cell of what the left eye sees";
  EXPECT_GT(twin.taken_hidden, found.hidden * 9 / 10);
}

TEST(OtherEye, LightsMirrorsAndGlossForEachEye) {
  TileScheduler scheduler(1);
  const Eyes eyes;
  const auto taken = [&](float roughness) {
    const auto scene = wall_behind_board(false, roughness);
    const Seen seen = seen_by(eyes, *scene, scheduler);
    return count(eyes, *scene, seen, seen);
  };
  EXPECT_EQ(taken(0.1F).taken, 0);
  const Count rough = taken(0.9F);
  EXPECT_GT(rough.taken, rough.all * 8 / 10);
}

TEST(OtherEye, TakesNothingFromCellsThatAreTwiceAsWide) {
  TileScheduler scheduler(1);
  const auto scene = wall_behind_board(false);
  for (const bool wider : {true, false}) {
    const Eyes eyes(wider);
    const Seen seen = seen_by(eyes, *scene, scheduler);
    EXPECT_EQ(count(eyes, *scene, seen, seen).taken == 0, wider);
  }
}

bool same_bits(const Plane<Rgb>& a, const Plane<Rgb>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Rgb)) == 0;
}

struct Pair {
  FrameBuffers out;
  FrameReport report;
};
/// The second frame of two.
Pair rendered(const Config& config, const SceneFrame& scene, int threads) {
  const Eyes eyes;
  const LightcutsKernel kernel(config);
  TileScheduler scheduler(threads);
  History history;
  Pair pair;
  for (std::uint64_t k = 0; k < 2; ++k)
    pair.report = kernel.render(eyes.request(k), scene, history, scheduler, pair.out);
  return pair;
}
Config config_with(StereoReuse stereo, LightShare share) {
  KernelOptions options;
  options.light_share = share;
  Config config = make_config(options);
  config.stereo = stereo;
  return config;
}

TEST(StereoReuse, TheFirstEyeKeepsItsBitsAndTheSecondChanges) {
  const auto scene = macula::test::frame_of(macula::test::small_room());
  for (const LightShare share : {LightShare::Uniform, LightShare::Perceived}) {
    const Pair lit = rendered(config_with(StereoReuse::No, share), *scene, 2);
    const Pair reused = rendered(config_with(StereoReuse::Yes, share), *scene, 2);
    EXPECT_TRUE(same_bits(lit.out.views[0].radiance, reused.out.views[0].radiance));
    EXPECT_FALSE(same_bits(lit.out.views[1].radiance, reused.out.views[1].radiance));
    EXPECT_LT(5 * reused.report.shadow_rays, 4 * lit.report.shadow_rays);
    EXPECT_EQ(reused.report.biased_shortcuts.size(), lit.report.biased_shortcuts.size() + 1);
  }
}

TEST(StereoReuse, TheSamePicturesComeFromAnyNumberOfThreads) {
  const auto scene = macula::test::frame_of(macula::test::small_room());
  for (const LightShare share : {LightShare::Uniform, LightShare::Perceived}) {
    const Config config = config_with(StereoReuse::Yes, share);
    const Pair one = rendered(config, *scene, 1), three = rendered(config, *scene, 3);
    for (std::size_t v = 0; v < 2; ++v)
      EXPECT_TRUE(same_bits(one.out.views[v].radiance, three.out.views[v].radiance)) << v;
  }
}

}  // namespace
}  // namespace macula::kernels::lightcuts
