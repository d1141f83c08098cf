// The GL pass against the CPU's warp, on frames of the built-in scenes: the same pictures but for
// what rounding decides at silhouettes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <string>

#include "client/display/gl/warp_pass.h"
#include "client/display/window/hidden_context.h"
#include "tests/bench/reprojection_setting.h"

namespace macula::bench {
namespace {

using reprojection::Coverage;
using reprojection::WarpOptions;

const foveation::Display kDisplay{math::symmetric_fov(Degrees{60.0}, 1.0), 160, 160};

/// A pixel whose surroundings belong to one surface: what silhouettes leave out, to one pixel.
bool is_inside(const image::Plane<float>& inverse_depth, int x, int y) {
  constexpr float kOneSurface = 0.05F;
  const float here = inverse_depth(x, y);
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      if (!inverse_depth.contains(x + i, y + j)) continue;
      const float there = inverse_depth(x + i, y + j);
      if (std::abs(there - here) > kOneSurface * std::max(here, there)) return false;
    }
  }
  return true;
}

struct Comparison {
  double psnr_db = 0.0;       ///< inside surfaces
  double compared_pct = 0.0;  ///< of all pixels
  double kinds_differ_pct = 0.0;
};
Comparison compare(const image::Plane<Rgb8>& a, const image::Plane<Rgb8>& b,
                   const image::Plane<float>& inverse_depth) {
  double squares = 0.0;
  int count = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      if (!is_inside(inverse_depth, x, y)) continue;
      const Rgb8 p = a(x, y), q = b(x, y);
      squares += std::pow(p.r - q.r, 2) + std::pow(p.g - q.g, 2) + std::pow(p.b - q.b, 2);
      ++count;
    }
  }
  Comparison comparison;
  comparison.psnr_db = 10.0 * std::log10(255.0 * 255.0 * 3.0 * count / std::max(squares, 1e-9));
  comparison.compared_pct = 100.0 * count / static_cast<double>(a.size());
  return comparison;
}

class WarpTwins : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (std::getenv("MACULA_TEST_HAS_DISPLAY") == nullptr && std::getenv("DISPLAY") == nullptr) {
      GTEST_SKIP() << "no display and no xvfb-run";
    }
    auto context = display::HiddenContext::create();
    ASSERT_TRUE(context) << context.error().message();
    context_ = std::move(*context);
    auto pass = display::WarpPass::create();
    ASSERT_TRUE(pass) << pass.error().message();
    pass_ = std::move(*pass);
    ASSERT_NO_FATAL_FAILURE(render_once());
    pass_->upload(source().view());
  }
  /// Scenes are loaded once for all tests.
  static void render_once() {
    if (sources().contains(GetParam())) return;
    auto setting = ReprojectionSetting::create(GetParam(), "lambert", 0);
    ASSERT_TRUE(setting) << setting.error().message();
    sources().emplace(GetParam(), setting->render(setting->stage_from_camera(),
                                                  guarded_raster(kDisplay, Degrees{8.0}), 0.05));
  }
  static std::map<std::string, SourcePicture>& sources() {
    static std::map<std::string, SourcePicture> rendered;
    return rendered;
  }
  static const SourcePicture& source() { return sources().at(GetParam()); }
  Pose moved(double turn_deg = 2.0) const {
    const Pose& from = source().stage_from_view;
    const DQuat turn =
        glm::angleAxis(Radians{Degrees{turn_deg}}.value(), glm::normalize(DVec3{0.3, 1.0, 0.2}));
    return {from.position + from.rotation * DVec3{0.03, 0.01, -0.015},
            glm::normalize(from.rotation * turn)};
  }
  /// The CPU's picture at `to` and the GL's at the moved pose.
  Comparison twins(const WarpOptions& options, const Pose& to) {
    reprojection::Warper warper;
    image::Plane<Rgb8> by_cpu, by_gl;
    image::Plane<Coverage> cpu_kinds, gl_kinds;
    warper.warp(source().view(), to, kDisplay, options, by_cpu, &cpu_kinds);
    pass_->warp(moved(), kDisplay, options, by_gl, &gl_kinds);
    image::Plane<float> inverse_depth;
    warper.copy_inverse_depth(inverse_depth);
    Comparison comparison = compare(by_cpu, by_gl, inverse_depth);
    int differ = 0;
    for (std::size_t i = 0; i < cpu_kinds.size(); ++i) {
      differ += cpu_kinds.data()[i] != gl_kinds.data()[i] ? 1 : 0;
    }
    comparison.kinds_differ_pct = 100.0 * differ / static_cast<double>(cpu_kinds.size());
    return comparison;
  }

  std::unique_ptr<display::HiddenContext> context_;
  std::unique_ptr<display::WarpPass> pass_;
};

TEST_P(WarpTwins, ShowTheSamePictureWithEveryStageOn) {
  const Comparison same = twins({}, moved());
  EXPECT_GE(same.psnr_db, 45.0);
  EXPECT_GT(same.compared_pct, 50.0);
  EXPECT_LT(same.kinds_differ_pct, 0.5);
}

TEST_P(WarpTwins, ShowTheSamePictureWithStagesSwitched) {
  for (const WarpOptions& options : {WarpOptions{.method = WarpOptions::Method::RotationOnly},
                                     WarpOptions{.silhouettes = WarpOptions::Silhouettes::Stretch},
                                     WarpOptions{.silhouettes = WarpOptions::Silhouettes::Cut,
                                     .layers = WarpOptions::Layers::First,
                                     .holes = WarpOptions::Holes::LeaveBlack},
                                     WarpOptions{.filter = WarpOptions::Filter::Bilinear}}) {
    EXPECT_GE(twins(options, moved()).psnr_db, 45.0);
  }
}

// The twin of the twins: a tenth of a degree is seen.
TEST_P(WarpTwins, DifferWhereOneLooksElsewhere) {
  EXPECT_LT(twins({}, moved(2.1)).psnr_db, 45.0);
}

INSTANTIATE_TEST_SUITE_P(Scenes, WarpTwins,
                         testing::Values("posts", "atrium", "city", "moving", "columns"));

}  // namespace
}  // namespace macula::bench
