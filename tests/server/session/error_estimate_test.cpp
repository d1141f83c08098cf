#include "server/session/error_estimate.h"

#include <cmath>

#include "server/session/view_builder.h"
#include "shared/foveation/eccentricity.h"
#include "shared/image/bilinear.h"
#include "shared/metrics/foveated.h"
#include "tests/conformance/test_scenes.h"

namespace macula::session {
namespace {

constexpr int kSide = 96;
constexpr std::uint64_t kJudgements = 24;

class ErrorEstimate : public testing::Test {
 protected:
  ErrorEstimate() {
    frame_.display = test::display(kSide);
    show_at(1.0);
    options_.area_light_samples = options_.ambient_samples = 1;
  }
  /// Frames of so much of the display's resolution, from here on.
  void show_at(double scale) {
    frame_.view.grid = make_scaled_grid(frame_.display, scale, frame_.view.gaze, {}, {}).grid;
  }
  image::Plane<Rgb> render(const kernels::View& view, int samples, std::uint64_t seed) {
    kernels::KernelOptions options = options_;
    options.mode = kernels::Mode::Exact;
    options.samples_per_cell = samples;
    return test::render("ray", options, *scene_, view, scheduler_, seed).planes().radiance;
  }
  image::Plane<Rgb> picture(int samples) { return render(frame_.view, samples, 7); }
  double estimate(const image::Plane<Rgb>& shown) {
    const auto reference = *kernels::make_reference("ray", options_);
    SpotError all;
    for (frame_.judgement = 0; frame_.judgement < kJudgements; ++frame_.judgement)
      all += *spot_error(*reference, *scene_, frame_, shown, scheduler_);
    return all.rmse();
  }
  /// At every pixel of the display, against a picture of many samples.
  double truth(const image::Plane<Rgb>& shown) {
    kernels::View whole = frame_.view;
    whole.grid = foveation::make_uniform_grid(frame_.display);
    const image::Plane<Rgb> right = render(whole, 144, 1);
    double sum = 0.0, weights = 0.0;
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const Vec3 ray = whole.grid.ray(x, y);
        const double weight =
            metrics::acuity_weight(foveation::eccentricity(whole.gaze.direction, ray)) *
            std::pow(static_cast<double>(glm::length(ray)), -3.0);
        const Rgb own = image::display_linear(
            whole.tone, image::bilinear(shown, *frame_.view.grid.locate(whole.grid.tangent(x, y))));
        const Rgb error = own - image::display_linear(whole.tone, right(x, y));
        sum += weight * static_cast<double>(glm::dot(error, error)) / 3.0, weights += weight;
      }
    }
    return std::sqrt(sum / weights);
  }
  kernels::TileScheduler scheduler_{2};
  std::shared_ptr<const kernels::SceneFrame> scene_ = test::frame_of(test::closed_room());
  kernels::KernelOptions options_;
  FrameToJudge frame_;
};

TEST_F(ErrorEstimate, IsTheErrorOfANoisyFrame) {
  const image::Plane<Rgb> noisy = picture(1);
  EXPECT_NEAR(estimate(noisy) / truth(noisy), 1.0, 0.15);
}

// Detail between cells: two pictures on the same cells would agree on the same wrong colours.
TEST_F(ErrorEstimate, IsTheErrorOfAFrameThatIsBlurred) {
  show_at(0.2);
  const image::Plane<Rgb> blurred = picture(144);
  EXPECT_NEAR(estimate(blurred) / truth(blurred), 1.0, 0.15);
}

// The must-fail twin of both: a frame a third darker has another error, and it shows.
TEST_F(ErrorEstimate, FindsWhatAFrameAloneHasWrong) {
  frame_.view.grid = foveation::make_uniform_grid(frame_.display);
  image::Plane<Rgb> shown = picture(144);
  const double right = estimate(shown);
  for (Rgb& value : shown.pixels()) value *= 0.67F;
  EXPECT_GT(estimate(shown), 3.0 * right);
  EXPECT_NEAR(estimate(shown) / truth(shown), 1.0, 0.15);
}

// A frame without error: what is left is the references' noise, whose mean is nothing.
TEST_F(ErrorEstimate, IsFarBelowTheNoiseOfWhatItIsFoundBy) {
  frame_.view.grid = foveation::make_uniform_grid(frame_.display);
  EXPECT_LT(estimate(picture(400)), 0.35 * truth(picture(4)));
}

}  // namespace
}  // namespace macula::session
