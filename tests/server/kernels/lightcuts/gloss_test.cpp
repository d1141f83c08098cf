// What glossy and specular surfaces reflect: by the lobe alone, once, and nothing twice.
#include "server/kernels/lightcuts/gloss.h"

#include <cmath>
#include <cstring>

#include "server/kernels/lightcuts/knobs.h"
#include "server/kernels/lightcuts/lightcuts_kernel.h"
#include "server/kernels/lightcuts/lobe.h"
#include "server/kernels/planes.h"
#include "server/kernels/scene_timeline.h"
#include "server/shading/ggx_albedo.h"
#include "tests/conformance/test_scenes.h"
#include "tests/server/lights/tree_oracle.h"

namespace macula::kernels::lightcuts {
namespace {

constexpr int kSide = 16;
constexpr std::uint32_t kBall = 3;  ///< surface id: the third instance of closed_room()

/// A closed room with a lamp, a panel and ambient light; its ball is of `material`.
scene::Scene room_with(const scene::Material& material) {
  scene::Scene scene = test::closed_room();
  scene.materials[1] = material;
  return scene;
}
scene::Material metal(float roughness) {
  scene::Material metal;
  metal.base_color = {0.9F, 0.7F, 0.4F};
  metal.metallic = 1.0F, metal.roughness = roughness;
  return metal;
}
/// Under it there is nothing to reflect diffusely: brute force's bounce is the lobe's.
scene::Material varnish(float roughness, float albedo = 0.0F) {
  scene::Material varnish;
  varnish.base_color = Rgb{albedo};
  varnish.roughness = roughness;
  return varnish;
}

KernelOptions exact(int bounces = 0) {
  KernelOptions options;
  options.mode = Mode::Exact;
  options.jitter = false;  // pictures of the same points: what differs is light
  options.area_light_samples = 8;
  options.bounces = bounces;
  return options;
}
Config glossy(Gloss gloss = Gloss::Yes) {
  Config config = make_config(exact());
  config.gloss = gloss;
  return config;
}

struct Shown {
  foveation::Display display = test::display(kSide, 40.0);
  View view = test::view_on(foveation::make_uniform_grid(display));
  FoveationMap map{{{view.grid, view.gaze, display.pixel_tangent()}}, {}};
};
struct Rendered {
  Plane<Rgb> radiance;
  Plane<std::uint32_t> surface_id;
  FrameReport report;
};
Rendered rendered(const Kernel& kernel, const SceneFrame& scene, std::uint64_t seed,
                  int threads = 0) {
  const Shown shown;
  scheduling::TileScheduler scheduler(threads);
  History history;
  FrameBuffers out;
  out.wanted = kSurfaceId;
  FrameReport report =
      kernel.render({{&shown.view, 1}, shown.map, 0, seed}, scene, history, scheduler, out);
  return {std::move(out.views.front().radiance), std::move(out.views.front().surface_id), report};
}
bool same_bits(const Plane<Rgb>& a, const Plane<Rgb>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Rgb)) == 0;
}

/// Luminance of the ball, mean over its cells and many seeds, and its standard error.
struct Estimate {
  double mean = 0.0, error = 0.0;

  /// How many standard errors `other` differs from this, plus `more`.
  double off(const Estimate& other, double more = 0.0) const {
    return std::abs(mean + more - other.mean) / std::hypot(error, other.error);
  }
};
Estimate ball(const Kernel& kernel, const SceneFrame& scene, std::uint64_t first_seed) {
  constexpr int kSeeds = 160;
  double sum = 0.0, square = 0.0;
  for (int s = 0; s < kSeeds; ++s) {
    const Rendered one = rendered(kernel, scene, first_seed + static_cast<std::uint64_t>(s));
    double light = 0.0;
    int cells = 0;
    for (std::size_t i = 0; i < one.radiance.size(); ++i) {
      if (one.surface_id.pixels()[i] != kBall) continue;
      light += static_cast<double>(image::luminance(one.radiance.pixels()[i])), ++cells;
    }
    EXPECT_GT(cells, kSide * kSide / 8);
    sum += light / cells, square += light / cells * (light / cells);
  }
  const double mean = sum / kSeeds;
  return {mean, std::sqrt(std::max(square / kSeeds - mean * mean, 0.0) / (kSeeds - 1))};
}
Estimate brute_force(const SceneFrame& scene, int bounces, std::uint64_t seed) {
  return ball(**make_kernel("brute", exact(bounces)), scene, seed);
}

struct Shining {
  const char* name;
  scene::Material material;
};
std::ostream& operator<<(std::ostream& out, const Shining& shining) {
  return out << shining.name;
}
class GlossReference : public testing::TestWithParam<Shining> {};

TEST_P(GlossReference, OneBounceIsBruteForcesAndNothingIsCountedTwice) {
  const auto scene = test::frame_of(room_with(GetParam().material));
  const Estimate truth = brute_force(*scene, 1, 1000);
  const Estimate found = ball(LightcutsKernel(glossy()), *scene, 5000);
  EXPECT_LT(found.off(truth), 4.0) << found.mean << " for " << truth.mean;
  EXPECT_LT(std::hypot(found.error, truth.error), 0.03 * truth.mean)
      << "means as uncertain as this would show nothing";
  const Estimate direct = ball(LightcutsKernel(glossy(Gloss::No)), *scene, 5000);
  EXPECT_GT(direct.off(truth), 4.0) << "without a bounce it must fail";
  // What the lobe's rays would see the panel send is what panels send to the lobe.
  scene::Scene panel = room_with(GetParam().material);
  panel.lights.clear();
  panel.settings.ambient = Rgb{0.0F};
  const Estimate emitted = brute_force(*test::frame_of(std::move(panel)), 0, 9000);
  EXPECT_GT(found.off(truth, emitted.mean), 4.0) << "emission counted twice must fail";
}

INSTANTIATE_TEST_SUITE_P(Materials, GlossReference,
                         testing::Values(Shining{"polished metal", metal(0.14F)},
                                         Shining{"brushed metal", metal(0.3F)},
                                         Shining{"dull metal", metal(0.5F)},
                                         Shining{"varnish", varnish(0.35F)}));

TEST(GlossPass, WhatLiesUnderAVarnishIsNotReflectedAgain) {
  const auto bounce_of = [](float albedo) {
    const auto scene = test::frame_of(room_with(varnish(0.3F, albedo)));
    const Rendered with = rendered(LightcutsKernel(glossy()), *scene, 3);
    const Rendered without = rendered(LightcutsKernel(glossy(Gloss::No)), *scene, 3);
    Plane<float> more(kSide, kSide);
    for (std::size_t i = 0; i < more.size(); ++i)
      if (with.surface_id.pixels()[i] == kBall)
        more.pixels()[i] =
            image::luminance(with.radiance.pixels()[i] - without.radiance.pixels()[i]);
    return more;
  };
  const Plane<float> black = bounce_of(0.0F), grey = bounce_of(0.8F);
  double sum = 0.0;
  for (std::size_t i = 0; i < black.size(); ++i) {
    EXPECT_NEAR(black.pixels()[i], grey.pixels()[i], 1e-5F);
    sum += static_cast<double>(black.pixels()[i]);
  }
  EXPECT_GT(sum, 0.1);
}

TEST(GlossPass, CostsNothingWhereNoMaterialIsGlossy) {
  const auto matt = test::frame_of(room_with(varnish(0.9F, 0.5F)));
  EXPECT_FALSE(has_gloss(*matt, glossy().ray));
  const Rendered with = rendered(LightcutsKernel(glossy()), *matt, 3);
  const Rendered without = rendered(LightcutsKernel(glossy(Gloss::No)), *matt, 3);
  EXPECT_TRUE(same_bits(with.radiance, without.radiance));
  EXPECT_EQ(with.report.shadow_rays, without.report.shadow_rays);
  const auto shiny = test::frame_of(room_with(varnish(0.2F, 0.5F)));
  EXPECT_TRUE(has_gloss(*shiny, glossy().ray));
  const Rendered reflects = rendered(LightcutsKernel(glossy()), *shiny, 3);
  EXPECT_GT(reflects.report.shadow_rays, with.report.shadow_rays);
  for (std::size_t i = 0; i < reflects.radiance.size(); ++i) {
    if (reflects.surface_id.pixels()[i] == kBall) continue;
    EXPECT_EQ(reflects.radiance.pixels()[i], with.radiance.pixels()[i]) << "cells without gloss";
  }
}

TEST(GlossPass, TheSamePictureComesFromAnyNumberOfThreads) {
  const auto scene = test::frame_of(room_with(metal(0.3F)));
  KernelOptions options;
  options.light_share = LightShare::Perceived;
  Config config = make_config(options);
  config.gloss = Gloss::Yes;
  const LightcutsKernel kernel(config);
  EXPECT_TRUE(
      same_bits(rendered(kernel, *scene, 5, 1).radiance, rendered(kernel, *scene, 5, 3).radiance));
}

TEST(GlossPass, SendsFewerRaysWhereTheEyeSeesLess) {
  Config config = make_config({});
  config.sizes = CutSizes::Perceived;
  EXPECT_EQ(gloss_rays(config, 1), config.gloss_rays.least);
  EXPECT_EQ(gloss_rays(config, 12), 6);
  EXPECT_EQ(gloss_rays(config, 48), config.gloss_rays.most);
  config.gloss_rays.most = 1;
  EXPECT_EQ(gloss_rays(config, 1), 1) << "no more than the most, whatever the least is";
  config.sizes = CutSizes::Uniform;
  EXPECT_EQ(gloss_rays(config, 48), 48);
}

/// A bronze ball, a lamp and, if `bounced`, a virtual light.
std::shared_ptr<const SceneFrame> bronze_ball(bool bounced) {
  scene::Scene scene = room_with(metal(0.4F));
  scene.materials[2].emission = Rgb{0.0F};
  scene.settings.ambient = Rgb{0.0F};
  const auto shared = std::make_shared<const scene::Scene>(std::move(scene));
  const scene::ScenePlan plan(scene::facts_of(*shared), {.kernel = "lightcuts"});
  const BouncedLight one = [](const SceneFrame&) {
    lights::VirtualPointLight light;
    light.position = {1.5F, 1.0F, -1.0F}, light.normal = glm::normalize(Vec3{-1, -1, -1});
    light.flux = Rgb{5.0F};
    return std::vector<lights::VirtualPointLight>{light};
  };
  return *(*SceneTimeline::create(shared, plan, bounced ? one : BouncedLight{}))->at({});
}
/// What both lights' cuts bring the ball.
double cuts_bring(const SceneFrame& scene, Gloss gloss) {
  const Shown shown;
  scheduling::TileScheduler scheduler;
  FrameBuffers out;
  std::vector<ViewSurfaces> surfaces;
  prepare_buffers({&shown.view, 1}, out);
  trace_surfaces({{&shown.view, 1}, shown.map, 0, 1}, scene, glossy().ray, scheduler, surfaces,
                 out);
  const Plane<std::uint16_t> nodes(kSide, kSide, 2);
  double sum = 0.0;
  for (const SurfaceTile& tile : surfaces.front().tiles) {
    std::vector<Rgb> slots(tile.points.count, Rgb{0.0F});
    CutWork work;
    add_cut_light(scene, tile, {nodes, 2, nullptr, nullptr, gloss}, work, slots);
    for (std::size_t i = 0; i < slots.size(); ++i)
      if (is_glossy(tile.points.reflectors.alpha.at[i]))
        sum += static_cast<double>(image::luminance(slots[i]));
  }
  return sum;
}

// A virtual light stands for what a surface reflects, and metal, which has nothing but its lobe,
// sees that surface.
TEST(GlossPass, VirtualLightsDoWithoutTheLobesOfGlossyPoints) {
  const auto lamp = bronze_ball(false), both = bronze_ball(true);
  ASSERT_EQ(both->placed_lights().size(), 2U);
  ASSERT_EQ(both->placed_lights().first_virtual(), 1U);
  ASSERT_EQ(lamp->placed_lights().first_virtual(), 1U);
  const double by_lamp = cuts_bring(*lamp, Gloss::No);
  EXPECT_GT(by_lamp, 0.0);
  EXPECT_GT(cuts_bring(*both, Gloss::No), 1.05 * by_lamp) << "counted twice";
  EXPECT_NEAR(cuts_bring(*both, Gloss::Yes), by_lamp, 1e-6 * by_lamp);
  EXPECT_EQ(cuts_bring(*lamp, Gloss::Yes), by_lamp);
}

// ---- the lobe ----

shading::ReflectorBatch one_reflector(const shading::Bsdf& bsdf, const Vec3& to_eye) {
  shading::ReflectorBatch batch{};
  const Vec3 up{0, 0, 1};
  batch.set(0, {bsdf, shading::make_shading_frame(up, up, to_eye)});
  return batch;
}

// In a uniform environment of radiance 1 a lobe reflects its directional albedo.
TEST(Lobe, TheMeanWeightOfItsDirectionsIsItsAlbedo) {
  for (const float alpha : {0.001F, 0.09F, 0.25F}) {
    for (const float slant : {0.1F, 0.8F, 1.3F}) {
      const shading::Bsdf bsdf{Rgb{0.6F}, Rgb{0.04F, 0.3F, 0.9F}, 1.0F, alpha};
      const Vec3 to_eye{std::sin(slant), 0.0F, std::cos(slant)};
      const auto batch = one_reflector(bsdf, to_eye);
      lights::test::Random random(7);
      DVec3 sum{0.0};
      constexpr int kDraws = 20'000;
      for (int k = 0; k < kDraws; ++k) {
        const Vec2 u{static_cast<float>(random.next()), static_cast<float>(random.next())};
        if (const auto sample = sample_lobe(batch, 0, u)) sum += DVec3(sample->weight);
      }
      const shading::GgxAlbedo parts = shading::ggx_albedo(std::cos(slant), alpha);
      for (int c = 0; c < 3; ++c) {
        const double albedo = static_cast<double>(bsdf.f0[c] * parts.a + bsdf.f90 * parts.b);
        EXPECT_NEAR(sum[c] / kDraws, albedo, 0.02 * albedo + 2e-3) << alpha << ' ' << slant;
      }
    }
  }
}

// What a direction's weight is taken over: f cos = weight x density.
TEST(Lobe, ItsDensityIsWhatWeightsOfItsDirectionsAreOver) {
  for (const float alpha : {0.03F, 0.12F, 0.25F}) {
    const shading::Bsdf bsdf{Rgb{0.0F}, Rgb{0.04F, 0.3F, 0.9F}, 1.0F, alpha};
    const Vec3 to_eye = glm::normalize(Vec3{0.4F, 0.1F, 0.8F});
    const auto batch = one_reflector(bsdf, to_eye);
    const shading::Reflector lobe(bsdf, shading::make_shading_frame({0, 0, 1}, {0, 0, 1}, to_eye));
    lights::test::Random random(11);
    for (int k = 0; k < 200; ++k) {
      const Vec2 u{static_cast<float>(random.next()), static_cast<float>(random.next())};
      const auto sample = sample_lobe(batch, 0, u);
      if (!sample) continue;
      const Rgb wanted = lobe.evaluate(sample->to_light);
      const Rgb got = lobe_density(batch, 0, sample->to_light) * sample->weight;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], wanted[c], 2e-3F * wanted[c] + 1e-6F);
    }
  }
}

TEST(Lobe, ItsRaysBringLampsNearbyAndCutsThoseAfar) {
  const Vec3 to_eye{0.0F, 0.0F, 1.0F}, aside = glm::normalize(Vec3{0.9F, 0.0F, 0.4F});
  const auto share = [&](float alpha, const Vec3& to_light, float meters, float area_m2) {
    const shading::Bsdf bsdf{Rgb{0.2F}, Rgb{0.04F}, 1.0F, alpha};
    return share_of_rays(one_reflector(bsdf, to_eye), 0, to_light, meters * meters, area_m2);
  };
  constexpr float kSmall_m2 = 1e-4F;
  EXPECT_GT(share(0.12F, to_eye, 0.1F, kSmall_m2), 0.99F);
  EXPECT_LT(share(0.12F, to_eye, 20.0F, kSmall_m2), 0.01F);
  EXPECT_LT(share(0.12F, aside, 1.0F, kSmall_m2), 0.01F) << "beside the lobe";
  EXPECT_GT(share(0.12F, to_eye, 20.0F, 10.0F), 0.99F) << "a large lamp";
  EXPECT_EQ(share(0.01F, aside, 20.0F, kSmall_m2), 1.0F) << "mirrors leave cuts nothing";
  float before = 1.0F;
  for (float meters = 0.0F; meters < 8.0F; meters += 0.25F) {
    const float now = share(0.2F, to_eye, meters, kSmall_m2);
    EXPECT_TRUE(0.0F <= now && now <= before) << meters;
    before = now;
  }
}

TEST(Lobe, WhatIsLeftWithoutItIsTheWholeLessABlackOnes) {
  const Vec3 to_eye = glm::normalize(Vec3{0.4F, 0.1F, 0.8F});
  const shading::Bsdf whole{Rgb{0.6F, 0.4F, 0.2F}, Rgb{0.04F}, 1.0F, 0.1F};
  shading::Bsdf black = whole;
  black.albedo = Rgb{0.0F};
  const auto batch = one_reflector(whole, to_eye);
  const shading::ShadingFrame frame = shading::make_shading_frame({0, 0, 1}, {0, 0, 1}, to_eye);
  const shading::Reflector full(whole, frame), lobe(black, frame);
  lights::test::Random random(3);
  for (int k = 0; k < 200; ++k) {
    const double z = 2.0 * random.next() - 1.0, phi = 6.2831853 * random.next();
    const double r = std::sqrt(1.0 - z * z);
    const Vec3 to_light(r * std::cos(phi), r * std::sin(phi), z);
    const Rgb wanted = full.evaluate(to_light) - lobe.evaluate(to_light);
    const Rgb got = reflect_diffusely(batch, 0, to_light, Rgb{1.0F});
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(got[c], wanted[c], 1e-5F + 1e-5F * full.evaluate(to_light)[c]);
    if (z <= 0.0) {
      EXPECT_EQ(got, Rgb{0.0F});
    }
  }
}

TEST(GlossPass, GoesWithOneSampleACell) {
  Config config = make_config({});
  EXPECT_TRUE(turn_knobs(KnobValues{{"gloss", "yes"}}, config));
  EXPECT_EQ(config.gloss, Gloss::Yes);
  const auto refused = turn_knobs(KnobValues{{"samples", "4"}}, config);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("samples=1"), std::string::npos);
}

}  // namespace
}  // namespace macula::kernels::lightcuts
