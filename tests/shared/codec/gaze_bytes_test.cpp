// What a disc of full quality that grows with the gaze's age costs in bytes: frames along recorded
// heads and eyes, of a picture with detail at every scale, averaged over each cell.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "shared/codec/color.h"
#include "shared/codec/h264.h"
#include "shared/foveation/eccentricity.h"
#include "shared/foveation/gaze_follower.h"
#include "shared/foveation/pixel_grid.h"
#include "tests/support/recorded_gazes.h"

namespace macula::codec {
namespace {

using foveation::FollowedGaze;

constexpr std::size_t kOctaves = 8;
using Waves = std::array<float, kOctaves>;

/// Of each cell along an axis, in waves of 0.06 to 6 cycles a degree; cells average them.
std::vector<Waves> waves_along(const std::vector<float>& edges, double turn_deg, double phase) {
  std::vector<Waves> along;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const double from = Degrees{Radians{std::atan(static_cast<double>(edges[i]))}}.value();
    const double to = Degrees{Radians{std::atan(static_cast<double>(edges[i + 1]))}}.value();
    Waves& waves = along.emplace_back();
    for (std::size_t octave = 0; octave < kOctaves; ++octave) {
      const double w = 2.0 * 3.14159265 * 0.06 * std::pow(1.93, octave);
      const double start = phase * (1.0 + static_cast<double>(octave)) + w * turn_deg;
      waves[octave] = static_cast<float>((std::cos(start + w * from) - std::cos(start + w * to)) /
                                         (w * (to - from)));
    }
  }
  return along;
}

image::Plane<Rgb8> picture_on(const PixelGrid& grid, const DQuat& stage_from_head) {
  const DVec3 ahead = stage_from_head * DVec3{0.0, 0.0, -1.0};
  const double yaw = Degrees{Radians{std::atan2(ahead.x, -ahead.z)}}.value();
  const double pitch = Degrees{Radians{std::asin(std::clamp(ahead.y, -1.0, 1.0))}}.value();
  const auto columns = waves_along(grid.x_edges, yaw, 0.7);
  const auto rows = waves_along(grid.y_edges, -pitch, 1.9);
  image::Plane<Rgb8> picture(grid.width(), grid.height());
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      float level = 128.0F;
      for (std::size_t octave = 0; octave < kOctaves; ++octave)
        level += 22.0F * columns[static_cast<std::size_t>(x)][octave] *
                 rows[static_cast<std::size_t>(y)][(octave + 1) % kOctaves];
      const auto byte = static_cast<std::uint8_t>(std::clamp(level, 0.0F, 255.0F));
      picture(x, y) = {byte, byte, byte};
    }
  }
  return picture;
}

double jpeg_bytes(const image::Plane<Rgb8>& picture) {
  return static_cast<double>(encode_color(picture, picture.rect(), {}).value().size());
}

/// Bytes of one stream after its first frame.
class Stream {
 public:
  void add(const FollowedGaze& followed, Degrees radius, const test::RecordedGaze& at) {
    const foveation::Display display{math::symmetric_fov(Degrees{90.0}, 1.0), 480, 480};
    const PixelGrid grid =
        foveation::make_foveal_grid(display, followed.centre, {}, {.full_rate_radius = radius});
    const auto picture = picture_on(grid, at.stage_from_head);
    jpeg += jpeg_bytes(picture);
    if (!encoder_) return;
    H264Encoder::FrameWish wish;
    wish.now = units::from_s(at.t_s);
    const auto coded = (*encoder_)->encode(picture, wish);
    ASSERT_TRUE(coded);
    if (frames_++ > 0) h264 += static_cast<double>(coded->bytes.size());
  }
  double jpeg = 0.0, h264 = 0.0;

 private:
  Result<std::unique_ptr<H264Encoder>> encoder_ = H264Encoder::create({});
  int frames_ = 0;
};

/// 36 frames a second of ten seconds, seen 60 ms after their gaze.
void stream_both(const std::vector<test::RecordedGaze>& samples, Stream& fixed, Stream& grown) {
  foveation::GazeFollower follower({.rest = Degrees{2.0}});
  for (std::size_t i = 350; i < std::min<std::size_t>(samples.size(), 350 + 120); ++i) {
    follower.add({samples[i].gaze}, ClientTime{units::from_s(1.0 + samples[i].t_s)});
    if (i % 2 != 0) continue;
    const FollowedGaze young = follower.follow(Nanoseconds{0});
    const FollowedGaze old = follower.follow(units::from_ms(60.0));
    fixed.add(young, young.radius, samples[i]);
    grown.add(old, old.radius, samples[i]);
  }
}

TEST(GazeBytes, OnRecordedGazesTheGrownDiscCostsLessThanAThirdMoreBytes) {
  MACULA_NEEDS_HANDED_DATA("traces");
  double fixed_jpeg = 0.0, grown_jpeg = 0.0, fixed_h264 = 0.0, grown_h264 = 0.0;
  for (const auto& file : test::recorded_gazes()) {
    Stream fixed, grown;
    stream_both(test::load_gazes(file), fixed, grown);
    fixed_jpeg += fixed.jpeg, grown_jpeg += grown.jpeg;
    fixed_h264 += fixed.h264, grown_h264 += grown.h264;
  }
  std::printf("bytes x %.3f as JPEG, x %.3f as H.264\n", grown_jpeg / fixed_jpeg,
              grown_h264 / fixed_h264);
  EXPECT_GT(grown_jpeg, fixed_jpeg) << "the disc does grow";
  EXPECT_LE(grown_jpeg, 1.3 * fixed_jpeg);
  if (!can_encode_h264()) return;
  EXPECT_GT(fixed_h264, 0.0);
  EXPECT_LE(grown_h264, 1.3 * fixed_h264);
}

}  // namespace
}  // namespace macula::codec
