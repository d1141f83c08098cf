#include "server/session/error_estimate.h"

#include "server/session/view_builder.h"
#include "tests/conformance/test_scenes.h"

namespace macula::session {
namespace {

class ErrorEstimate : public testing::Test {
 protected:
  ErrorEstimate() {
    frame_.display = test::display(96);
    frame_.view.grid =
        make_scaled_grid(frame_.display, 1.0, frame_.view.gaze, frame_.model, frame_.grid).grid;
    options_.mode = kernels::Mode::Exact;
    options_.area_light_samples = options_.ambient_samples = 1;
  }
  image::Plane<Rgb> picture(int samples, std::uint64_t seed) {
    kernels::KernelOptions options = options_;
    options.samples_per_cell = samples;
    return test::render("ray", options, *scene_, frame_.view, scheduler_, seed).planes().radiance;
  }
  double estimate(const image::Plane<Rgb>& shown) {
    const auto kernel = *kernels::make_kernel("ray", options_);
    return *half_picture_difference(*kernel, *scene_, frame_, shown, scheduler_);
  }
  kernels::TileScheduler scheduler_{2};
  std::shared_ptr<const kernels::SceneFrame> scene_ = test::frame_of(test::closed_room());
  kernels::KernelOptions options_;
  FrameToJudge frame_;
};

TEST_F(ErrorEstimate, IsSmallerOfAFrameThatIsNearerToTheTruth) {
  const double noisy = estimate(picture(1, 7)), clean = estimate(picture(64, 7));
  EXPECT_LT(clean, 0.5 * noisy) << "though the two pictures it is judged by are as noisy as before";
}

TEST_F(ErrorEstimate, FindsWhatAFrameAloneHasWrong) {
  image::Plane<Rgb> dark = picture(64, 7);
  const double right = estimate(dark);
  for (Rgb& value : dark.pixels()) value *= 0.5F;
  EXPECT_GT(estimate(dark), 3.0 * right);
}

}  // namespace
}  // namespace macula::session
