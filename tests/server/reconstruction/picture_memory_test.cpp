#include "server/reconstruction/picture_memory.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "shared/math/hash.h"

namespace macula::reconstruction {
namespace {

constexpr int kSide = 40;
constexpr float kStep = 0.02F;  ///< of the grid, tangents
constexpr float kWall_m = 4.0F;

/// Radiance of the cell at a place on the wall, meters, in a frame.
using Shows = std::function<float(const Vec2& place, int frame)>;

struct Frames {
  SteadyConfig config;
  PictureMemory memory;
  image::Plane<Rgb> shown;
  int count = 0;
  const Movers* movers = nullptr;

  /// A wall straight ahead of an eye that has moved to the right.
  void show(float right_m, const Shows& shows) {
    PictureMemory now;
    now.world_from_view.position = {static_cast<double>(right_m), 0.0, 0.0};
    for (int i = 0; i <= kSide; ++i)
      now.grid.x_edges.push_back(kStep * static_cast<float>(i - kSide / 2));
    now.grid.y_edges = now.grid.x_edges;
    image::Plane<Rgb> fresh(kSide, kSide);
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x)
        fresh(x, y) = Rgb{shows(kWall_m * now.grid.tangent(x, y) + Vec2{right_m, 0.0F}, count)};
    }
    const image::Plane<float> inverse_depth(kSide, kSide, 1.0F / kWall_m);
    PictureJoin joined(count > 0 ? &memory : nullptr, config, fresh, inverse_depth, now);
    if (movers != nullptr) joined.follow(*movers);
    shown = image::Plane<Rgb>(kSide, kSide);
    for (int y = 0; y < kSide; ++y) joined.prepare_row(y);
    for (int y = 0; y < kSide; ++y) joined.join_row(y, shown.row(y));
    memory = std::move(now);
    ++count;
  }
  /// Over the middle, against what a wall shows.
  double rms(float right_m, const Shows& truth) const {
    double sum = 0.0;
    int cells = 0;
    for (int y = 8; y < kSide - 8; ++y) {
      for (int x = 8; x < kSide - 8; ++x, ++cells) {
        const Vec2 place = kWall_m * memory.grid.tangent(x, y) + Vec2{right_m, 0.0F};
        sum += std::pow(static_cast<double>(shown(x, y).y - truth(place, 0)), 2);
      }
    }
    return std::sqrt(sum / cells);
  }
};

float striped(const Vec2& place, int) {
  return 0.5F + 0.3F * std::sin(6.0F * place.x);
}
/// One of two in every cell and frame, by chance.
float flickering(const Vec2& place, int frame) {
  const auto bits = [](float v) {
    return static_cast<std::uint64_t>(std::lround(v * 1e4F) + 100'000);
  };
  const float u = math::unit_float(math::hash_combine(
      math::hash_combine(bits(place.x), bits(place.y)), static_cast<std::uint64_t>(frame)));
  return u < 0.5F ? 0.2F : 0.8F;
}

TEST(PictureMemory, AFirstFrameIsShownAsItIs) {
  Frames frames;
  frames.show(0.0F, striped);
  EXPECT_LT(frames.rms(0.0F, striped), 1e-6);
}

TEST(PictureMemory, SamplesOfACellBecomeTheirMean) {
  Frames frames;
  for (int k = 0; k < 16; ++k) frames.show(0.0F, flickering);
  const Shows mean = [](const Vec2&, int) { return 0.5F; };
  EXPECT_LT(frames.rms(0.0F, mean), 0.3 / 2.5) << "a deviation of .3 over eight frames";
  Frames forgetful;
  forgetful.config.most_frames = 1.0F;
  for (int k = 0; k < 16; ++k) forgetful.show(0.0F, flickering);
  EXPECT_GT(forgetful.rms(0.0F, mean), 0.29);
}

TEST(PictureMemory, WhatIsShownStaysOnItsSurfaceWhileTheEyeMoves) {
  Frames frames;
  for (int k = 0; k < 10; ++k) frames.show(0.03F * static_cast<float>(k), striped);
  EXPECT_LT(frames.rms(0.27F, striped), 0.02);
}

// Beads of a turning ring dissolved: what they had shown was looked for where the background was.
TEST(PictureMemory, WhatIsShownStaysOnASurfaceThatMovesWhileTheEyeIsStill) {
  constexpr float kStep_m = 0.05F;
  const Shows carried = [](const Vec2& place, int frame) {
    return striped(place - Vec2{kStep_m * static_cast<float>(frame), 0.0F}, frame);
  };
  constexpr int kFrames = 10;
  const Shows last = [&](const Vec2& place, int) { return carried(place, kFrames - 1); };
  const auto rms_with = [&](const Movers* movers) {
    Frames frames;
    frames.config.deviations = 3.0F;
    frames.movers = movers;
    for (int k = 0; k < kFrames; ++k) frames.show(0.0F, carried);
    return frames.rms(0.0F, last);
  };
  Movers wall;
  wall.of.resize(kSide, kSide, 1U);
  wall.then_from_now.resize(1);
  wall.then_from_now.front().position = {-static_cast<double>(kStep_m), 0.0, 0.0};
  EXPECT_LT(rms_with(&wall), 0.02);
  EXPECT_GT(rms_with(nullptr), 0.05) << "left where it was";
  wall.of.resize(0, 0), wall.of.resize(kSide, kSide, 0U);
  EXPECT_GT(rms_with(&wall), 0.05) << "cells of nothing that moves are not carried";
}

TEST(PictureMemory, WhatThePictureNoLongerShowsIsForgottenAtOnce) {
  const Shows bright = [](const Vec2&, int) { return 0.9F; };
  const Shows dark = [](const Vec2&, int) { return 0.1F; };
  Frames frames;
  for (int k = 0; k < 10; ++k) frames.show(0.0F, bright);
  frames.show(0.0F, dark);
  EXPECT_LT(frames.rms(0.0F, dark), 1e-3);
  Frames unbounded;
  unbounded.config.deviations = 1e6F;
  for (int k = 0; k < 10; ++k) unbounded.show(0.0F, bright);
  unbounded.show(0.0F, dark);
  EXPECT_NEAR(unbounded.rms(0.0F, dark), 0.8 * 7 / 8, 0.01) << "seven eighths would be left";
}

}  // namespace
}  // namespace macula::reconstruction
