// The warp against the renderer: a frame rendered at an old pose, warped to the display's pose,
// beside the picture rendered at that pose. Scene `posts`, uniform grid with a guard band of 12
// degrees, 60-degree view, Lambert, 3x3 fixed samples, 8-bit sRGB, no codec. PSNR over pixels
// inside the frame; medians over poses whose turn stays within the guard band.
#include "client/reprojection/warp.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "server/kernels/registry.h"
#include "server/scene/load.h"
#include "tests/conformance/head_trace.h"
#include "tests/support/handed_data.h"

namespace macula {
namespace {

using reprojection::Coverage;
using reprojection::WarpOptions;

constexpr Degrees kView{60.0}, kGuard{12.0};
constexpr int kSide_px = 600;

foveation::Display display() {
  return {math::symmetric_fov(kView, 1.0), kSide_px, kSide_px};
}

/// The display's raster, carried on over the guard band.
PixelGrid guarded_grid() {
  const DVec2 step = display().pixel_tangent();
  const double reach = std::tan(0.5 * Radians(kView).value() + Radians(kGuard).value());
  const int margin = static_cast<int>(std::ceil(reach / step.x - 0.5 * kSide_px));
  std::vector<float> edges;
  for (int i = -margin; i <= kSide_px + margin; ++i) {
    edges.push_back(static_cast<float>((i - 0.5 * kSide_px) * step.x));
  }
  return {edges, edges};
}

struct Picture {
  Pose pose;
  PixelGrid grid;
  image::Plane<Rgb8> color;
  image::Plane<float> inverse_depth;
  reprojection::SourceView view() const { return {pose, grid, color, inverse_depth}; }
};

class Renderer {
 public:
  Renderer() {
    const auto scene = scene::load_scene("posts");
    tone_ = (*scene)->settings.tone;
    scene_from_stage_ = (*scene)->settings.scene_from_stage;
    frame_ = *kernels::SceneFrame::create(*scene);
    kernels::KernelOptions options;
    options.mode = kernels::Mode::Exact;
    options.samples_per_cell = 9;
    options.jitter = false;
    options.ambient_samples = 0;
    options.lambert_only = true;
    kernel_ = *kernels::make_kernel("ray", options);
  }

  Picture render(const Pose& stage_from_view, const PixelGrid& grid) {
    const kernels::View view{scene_from_stage_ * stage_from_view, grid, {}, tone_};
    const FoveationMap full({{grid, {}, display().pixel_tangent()}},
                            {.curve = foveation::RateCurve::Uniform});
    kernels::FrameBuffers buffers;
    kernels::History history;
    const auto report =
        kernel_->render({{&view, 1}, full, 0, 0}, *frame_, history, tiles_, buffers);
    EXPECT_EQ(report.non_finite_samples, 0U);
    Picture picture{stage_from_view, grid, {}, {grid.width(), grid.height()}};
    image::encode(tone_, buffers.views[0].radiance, picture.color);
    const auto depths = buffers.views[0].depth_m.pixels();
    std::transform(depths.begin(), depths.end(), picture.inverse_depth.data(),
                   [](float depth_m) { return 1.0F / depth_m; });
    return picture;
  }

 private:
  std::shared_ptr<const kernels::SceneFrame> frame_;
  std::unique_ptr<kernels::Kernel> kernel_;
  image::Tone tone_;
  Pose scene_from_stage_;
  kernels::TileScheduler tiles_;
};

struct Score {
  double psnr_db = 0.0;
  double filled_share = 0.0;
};
Score score(const Picture& source, const Picture& expected, const WarpOptions& options) {
  image::Plane<Rgb8> shown;
  image::Plane<Coverage> coverage;
  const auto report =
      reprojection::warp(source.view(), expected.pose, display(), options, shown, &coverage);
  double squares = 0.0, values = 0.0;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (coverage.data()[i] == Coverage::Outside) continue;
    const Rgb8 a = shown.data()[i], b = expected.color.data()[i];
    squares += std::pow(a.r - b.r, 2) + std::pow(a.g - b.g, 2) + std::pow(a.b - b.b, 2);
    values += 3.0;
  }
  constexpr double kEqual_db = 99.0;
  const double psnr =
      squares == 0.0 ? kEqual_db : 10.0 * std::log10(255.0 * 255.0 * values / squares);
  return {psnr, report.filled_share()};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 != 0 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

/// Medians over the pairs of poses of one age.
struct Row {
  std::vector<double> mesh, bilinear, rotation, stale, filled, turn_deg, offset_cm;

  void add(const Picture& source, const Picture& expected) {
    const Score best = score(source, expected, {});
    mesh.push_back(best.psnr_db);
    filled.push_back(best.filled_share);
    const auto psnr_db = [&](const WarpOptions& options) {
      return score(source, expected, options).psnr_db;
    };
    bilinear.push_back(psnr_db({.filter = WarpOptions::Filter::Bilinear}));
    rotation.push_back(psnr_db({.method = WarpOptions::Method::RotationOnly}));
    stale.push_back(psnr_db({.method = WarpOptions::Method::Stale}));
    turn_deg.push_back(Degrees(math::angle_between(source.pose, expected.pose)).value());
    offset_cm.push_back(100.0 * glm::distance(source.pose.position, expected.pose.position));
  }
  void print(const char* age) const {
    std::printf(
        "%-6s %zu poses: mesh %.1f dB (bilinear %.1f), rotation only %.1f, stale %.1f; filled %.2f "
        "%%,"
        " turn %.1f deg, offset %.1f cm\n",
        age, mesh.size(), median(mesh), median(bilinear), median(rotation), median(stale),
        100.0 * median(filled), median(turn_deg), median(offset_cm));
  }
};

/// Carries poses to where the objects are: `now` stands in the middle of the room and looks along
/// -Z, as level as recorded; the motion up to it stays as recorded.
Pose stage_from_trace(const Pose& now) {
  const DVec3 ahead = now.rotation * DVec3{0, 0, -1};
  const DQuat level = glm::angleAxis(std::atan2(ahead.x, -ahead.z), DVec3{0, 1, 0});
  const DVec3 at = level * DVec3{now.position.x, 0.0, now.position.z};
  return {DVec3{0.0, 1.6 - now.position.y, 0.0} - at, level};
}

TEST(ReprojectionConformance, TheSamePoseReproducesTheRenderedPicture) {
  Renderer renderer;
  const Pose pose = math::look_at({0.0, 1.6, 0.0}, {0.0, 1.4, -2.5}, {0, 1, 0});
  const Picture expected = renderer.render(pose, foveation::make_uniform_grid(display()));
  EXPECT_GE(score(expected, expected, {}).psnr_db, 60.0);
  const Picture guarded = renderer.render(pose, guarded_grid());
  EXPECT_GE(score(guarded, expected, {}).psnr_db, 60.0);
}

TEST(ReprojectionConformance, ASteadyVigorousMotionKeepsTheBars) {
  // 50 degrees and 0.25 m a second, in three directions; runs where no recorded trace is at hand.
  Renderer renderer;
  const Pose now = math::look_at({0.0, 1.6, 0.0}, {0.0, 1.4, -2.5}, {0, 1, 0});
  const Picture expected = renderer.render(now, foveation::make_uniform_grid(display()));
  Row at_50, at_100;
  for (const auto& [axis, way] : {std::pair{DVec3{0, 1, 0}, DVec3{1, 0, 0}},
                                  {DVec3{0.3, -1, 0}, DVec3{0.6, 0.3, 0.7}},
                                  {DVec3{1, 0.5, 0.2}, DVec3{0.5, 0.5, -0.7}}}) {
    for (Row* row : {&at_50, &at_100}) {
      const double age_s = row == &at_50 ? 0.05 : 0.1;
      const DQuat turn =
          glm::angleAxis(Radians(Degrees{50.0 * age_s}).value(), glm::normalize(axis));
      const Pose old{now.position + 0.25 * age_s * glm::normalize(way),
                     glm::normalize(turn * now.rotation)};
      row->add(renderer.render(old, guarded_grid()), expected);
    }
  }
  at_50.print("50 ms");
  at_100.print("100 ms");
  EXPECT_GE(median(at_50.mesh), 36.0);
  EXPECT_GE(median(at_100.mesh), 34.0);
  EXPECT_GE(median(at_100.mesh), median(at_100.rotation) + 6.0);  // what depth is worth
}

TEST(ReprojectionConformance, ARecordedHeadsMotionKeepsTheBars) {
  MACULA_NEEDS_HANDED_DATA("traces/eyenavgs_u105_london.csv");
  const test::HeadTrace trace((test::handed_data() / "traces/eyenavgs_u105_london.csv").string());
  ASSERT_FALSE(trace.empty());
  Renderer renderer;
  Row at_50, at_100;
  const double start_s = trace.most_vigorous(10.0);
  for (double now_s = start_s + 0.5; now_s < start_s + 10.0; now_s += 2.0) {
    const Pose stage = stage_from_trace(trace.at(now_s)), now = stage * trace.at(now_s);
    const Picture expected = renderer.render(now, foveation::make_uniform_grid(display()));
    for (Row* row : {&at_50, &at_100}) {
      const Pose old = stage * trace.at(now_s - (row == &at_50 ? 0.05 : 0.1));
      if (math::angle_between(old, now) > Radians(kGuard)) continue;
      row->add(renderer.render(old, guarded_grid()), expected);
    }
  }
  at_50.print("50 ms");
  at_100.print("100 ms");
  ASSERT_GE(at_100.mesh.size(), 3U);
  EXPECT_GE(median(at_50.mesh), 36.0);
  EXPECT_GE(median(at_100.mesh), 34.0);
  EXPECT_GE(median(at_100.mesh), median(at_100.rotation) + 6.0);
}

}  // namespace
}  // namespace macula
