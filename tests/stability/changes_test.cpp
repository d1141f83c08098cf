// What kernels remember, when the view changes by leaps: no ghost of what was is left in the fovea
// two frames later, and odd sequences of frames show what a single one does.
#include <cmath>

#include "server/scene/load.h"
#include "shared/base/text.h"
#include "tests/stability/shot.h"

namespace macula::stability {
namespace {

/// One viewer of a lit room: the frames it saw, one after the other.
class Viewer {
 public:
  explicit Viewer(const std::string& kernel, int side = 64) : side_(side) {
    kernels::KernelOptions options;
    options.reuse = kernels::Reuse::EarlierFrames;
    options.light_share = kernels::LightShare::Perceived;
    kernel_ = *kernels::make_kernel(kernel, options);
    static const auto field = test::frame_of(**scene::load_scene("columns"));
    static const auto room = test::frame_of(test::closed_room());
    scene_ = kernel == "sphere" ? field : room;
    if (kernel == "sphere") start_ = field->pose().world_from_view.front();
  }

  /// The view is turned by `yaw` to the left and moved by `shift` in its own frame.
  const image::Plane<Rgb>& look(std::uint64_t frame, const DVec3& shift, Degrees yaw,
                                const Gaze& gaze = {}) {
    kernels::View view;
    view.grid = foveation::make_uniform_grid(test::display(side_, 90.0));
    const Radians turned{yaw};
    view.world_from_view =
        start_ * Pose{shift, glm::angleAxis(turned.value(), DVec3{0.0, 1.0, 0.0})};
    view.gaze = gaze;
    const foveation::RateModel rate{foveation::RateCurve::Ray, Degrees{10.0}, Degrees{25.0}, 0.1};
    const FoveationMap map({{view.grid, gaze, DVec2{2.0 / side_}}}, rate);
    kernel_->render({{&view, 1}, map, frame, frame}, *scene_, history_, scheduler(), buffers_);
    gaze_ = gaze;
    return buffers_.views.front().radiance;
  }
  void change_size(int side) { side_ = side; }

  /// RMS of the difference to `truth` within 10 degrees of the gaze.
  double error_in_fovea(const image::Plane<Rgb>& truth) const {
    const auto& got = buffers_.views.front().radiance;
    const auto grid = foveation::make_uniform_grid(test::display(side_, 90.0));
    double sum = 0.0;
    int cells = 0;
    for (int y = 0; y < side_; ++y) {
      for (int x = 0; x < side_; ++x) {
        const float cosine = glm::dot(glm::normalize(grid.ray(x, y)), gaze_.direction);
        if (cosine < std::cos(10.0F * 0.0174533F)) continue;
        const double difference =
            image::luminance(got(x, y)) - static_cast<double>(image::luminance(truth(x, y)));
        sum += difference * difference, ++cells;
      }
    }
    return std::sqrt(sum / cells);
  }

 private:
  static kernels::TileScheduler& scheduler() {
    static kernels::TileScheduler shared(2);
    return shared;
  }

  int side_;
  std::unique_ptr<kernels::Kernel> kernel_;
  std::shared_ptr<const kernels::SceneFrame> scene_;
  Pose start_;
  kernels::History history_;
  kernels::FrameBuffers buffers_;
  Gaze gaze_;
};

Gaze looking_aside() {
  Gaze gaze;
  gaze.direction = glm::normalize(Vec3{-0.5774F, 0.0F, -1.0F});  // 30 degrees
  return gaze;
}
Gaze looking_to_the_other_side() {
  Gaze gaze = looking_aside();
  gaze.direction.x = -gaze.direction.x;
  return gaze;
}

class Changes : public testing::TestWithParam<const char*> {
 protected:
  static constexpr DVec3 kAside{0.35, 0.1, -0.4};
  /// The mean of many frames of a view at rest that was never another.
  static image::Plane<Rgb> truth(const DVec3& shift, Degrees yaw, const Gaze& gaze) {
    image::Plane<Rgb> mean(64, 64, Rgb{0.0F});
    constexpr int kFrames = 24;
    for (int i = 0; i < kFrames; ++i) {
      Viewer fresh(GetParam());
      const auto& frame = fresh.look(1000 + static_cast<std::uint64_t>(i), shift, yaw, gaze);
      for (std::size_t p = 0; p < mean.size(); ++p)
        mean.pixels()[p] += frame.pixels()[p] / static_cast<float>(kFrames);
    }
    return mean;
  }
};

// The comparison is with a viewer that has just come: it knows as little as one may know after a
// cut, and no more than 1.2 times its error may be left.
TEST_P(Changes, ATeleportLeavesNoGhostInTheFoveaAfterTwoFrames) {
  const auto wanted = truth(kAside, Degrees{60.0}, {});
  Viewer moved(GetParam()), fresh(GetParam());
  for (std::uint64_t i = 0; i < 6; ++i) moved.look(i, {}, Degrees{0.0});
  for (std::uint64_t i = 6; i < 8; ++i) moved.look(i, kAside, Degrees{60.0});
  for (std::uint64_t i = 6; i < 8; ++i) fresh.look(i, kAside, Degrees{60.0});
  const double started = fresh.error_in_fovea(wanted);
  EXPECT_LE(moved.error_in_fovea(wanted), 1.2 * started + 1e-4);
  Viewer stays(GetParam());
  for (std::uint64_t i = 0; i < 8; ++i) stays.look(i, {}, Degrees{0.0});
  EXPECT_GT(stays.error_in_fovea(wanted), 2.0 * started) << "a ghost must be seen";
}

TEST_P(Changes, ASaccadeOfSixtyDegreesLeavesNoGhostInTheFoveaAfterTwoFrames) {
  const auto wanted = truth({}, Degrees{0.0}, looking_to_the_other_side());
  Viewer moved(GetParam()), fresh(GetParam());
  for (std::uint64_t i = 0; i < 6; ++i) moved.look(i, {}, Degrees{0.0}, looking_aside());
  for (std::uint64_t i = 6; i < 8; ++i)
    moved.look(i, {}, Degrees{0.0}, looking_to_the_other_side());
  for (std::uint64_t i = 6; i < 8; ++i)
    fresh.look(i, {}, Degrees{0.0}, looking_to_the_other_side());
  EXPECT_LE(moved.error_in_fovea(wanted), 1.2 * fresh.error_in_fovea(wanted) + 1e-4);
}

TEST_P(Changes, TheSameFrameTwiceChangesLittle) {
  const auto wanted = truth({}, Degrees{0.0}, {});
  Viewer twice(GetParam()), fresh(GetParam());
  for (int i = 0; i < 3; ++i) twice.look(7, {}, Degrees{0.0});
  fresh.look(7, {}, Degrees{0.0});
  EXPECT_LE(twice.error_in_fovea(wanted), 1.2 * fresh.error_in_fovea(wanted) + 1e-4);
}

TEST_P(Changes, FrameNumbersMayGoBack) {
  const auto wanted = truth({}, Degrees{0.0}, {});
  Viewer back(GetParam()), fresh(GetParam());
  for (const std::uint64_t frame : {~std::uint64_t{0}, std::uint64_t{0}, std::uint64_t{5}})
    back.look(frame, {}, Degrees{0.0});
  fresh.look(5, {}, Degrees{0.0});
  EXPECT_LE(back.error_in_fovea(wanted), 1.2 * fresh.error_in_fovea(wanted) + 1e-4);
}

TEST_P(Changes, ThePictureMayChangeItsSizeFromFrameToFrame) {
  const auto wanted = truth({}, Degrees{0.0}, {});
  Viewer changing(GetParam()), fresh(GetParam());
  std::uint64_t frame = 0;
  for (const int side : {64, 1, 100, 7, 64, 64}) {
    changing.change_size(side);
    const auto& picture = changing.look(frame++, {}, Degrees{0.0});
    ASSERT_EQ(picture.width(), side);
    for (const Rgb& value : picture.pixels()) ASSERT_TRUE(math::is_finite(value));
  }
  for (const std::uint64_t last : {frame - 2, frame - 1}) fresh.look(last, {}, Degrees{0.0});
  EXPECT_LE(changing.error_in_fovea(wanted), 1.2 * fresh.error_in_fovea(wanted) + 1e-4);
}

INSTANTIATE_TEST_SUITE_P(EveryKernel, Changes,
                         testing::Values("ray", "lightcuts", "culling", "sphere"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace macula::stability
