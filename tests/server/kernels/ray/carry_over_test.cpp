#include "server/kernels/ray/carry_over.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "server/kernels/planes.h"
#include "server/sampling/sample.h"

namespace macula::kernels::ray {
namespace {

constexpr int kWidth = 53, kHeight = 41;

float chance(int x, int y, std::uint32_t dimension) {
  return sampling::sample(1, 2, static_cast<std::uint64_t>(y) * kWidth + x, dimension);
}
Rgb color(int x, int y, std::uint32_t dimension) {
  return {chance(x, y, dimension), chance(x, y, dimension + 1), chance(x, y, dimension + 2)};
}

/// A wall with steps, remembered with gaps, whose chosen cells bring something else.
class Frame {
 public:
  explicit Frame(bool moves) : moves_(moves) {
    mask_.choose(probability_, 3, 1, config_, scheduler_);
    fresh_.prepare(kWidth, kHeight, kNormal, mask_.chosen().size());
    fresh_.place(mask_.chosen());
    for (const auto& [x, y] : mask_.chosen()) {
      const std::size_t at = fresh_.at(x, y);
      fresh_.planes().radiance.data()[at] = color(x, y, 0);
      fresh_.planes().depth_m.data()[at] = depth_m(x, y) * (chance(x, y, 3) < 0.1F ? 0.5F : 1.0F);
    }
    for (int row = 0; row < fresh_.chroma().height(); ++row)
      fresh_.add_chroma(row, FreshSamples::kBatch);
    support_.fill(fresh_, config_);
    prepare_cache(then_, kWidth, kHeight, false, 0);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        then_.color(x, y) = Texel(glm::sqrt(color(x, y, 4)));
        then_.info(x, y) = {8.0F, 8.0F, 1};
        then_.inverse_depth(x, y) =
            chance(x, y, 7) < 0.05F ? Cache::kNothing : 1.0F / depth_m(x, y);
      }
    }
  }

  /// What is left in the memory and in the frame, and what was forgotten.
  struct Left {
    std::vector<Rgb> shown, remembered;
    std::vector<float> depth_m, inverse_depth, luminance;
    std::vector<std::pair<int, int>> forgotten;
    bool operator==(const Left&) const = default;
  };
  Left carried(int rows_at_once) {
    Cache now = then_;
    Plane<float> depths_then = then_.inverse_depth;
    ViewBuffers out;
    prepare_planes(out, 0, kWidth, kHeight);
    SupportLuminance luminance{Plane<float>(support_.x.count(), support_.y.count()),
                               Plane<float>(support_.x.count(), support_.y.count())};
    const Pose stood{{0.02, -0.01, 0.03}, {1.0, 0.0, 0.0, 0.0}};
    std::optional<Reprojector> moved;
    const ReprojectJob reprojection{then_, stood, grid_, view_, support_, config_, 3};
    if (moves_) moved.emplace(reprojection, now);
    const MergeJob merge{view_, support_,       mask_,        fresh_, config_,
                         2,     Motion::Moving, GlossyPast{}, 3};
    const CarryOver carrying(merge, moved ? &*moved : nullptr, depths_then, now, out, luminance);
    Left left;
    for (int first = 0; first < kHeight; first += rows_at_once) {
      const auto brought = carrying.rows(first, std::min(first + rows_at_once, kHeight));
      for (const auto& [x, y] : brought.forgotten) left.forgotten.emplace_back(x, y);
    }
    const auto keep = [](const auto& plane, auto& kept) {
      kept.assign(plane.pixels().begin(), plane.pixels().end());
    };
    keep(out.radiance, left.shown), keep(out.depth_m, left.depth_m);
    keep(now.inverse_depth, left.inverse_depth), keep(luminance.remembered, left.luminance);
    for (const Texel& texel : now.color.pixels()) left.remembered.push_back(texel.rgb());
    return left;
  }
  const SamplingMask& mask() const { return mask_; }
  const Cache& then() const { return then_; }

 private:
  static float depth_m(int x, int y) {
    return 2.0F + (x > 20 ? 0.7F : 0.0F) + (y > 23 ? 1.1F : 0.0F);
  }

  bool moves_;
  FoveatedConfig config_;
  foveation::Display screen_{math::symmetric_fov(Degrees{80.0}, 0.8), kWidth, kHeight};
  PixelGrid grid_ = foveation::make_uniform_grid(screen_);
  View view_{{}, grid_, {}, {}};
  foveation::RateModel rate_{foveation::RateCurve::Ray, Degrees{10}, Degrees{20}, 0.2};
  FoveationMap map_{{{grid_, {}, screen_.pixel_tangent()}}, rate_};
  Probability probability_{map_.view(0), rate_};
  TileScheduler scheduler_{2};
  Support support_{grid_, 4.61F};
  SamplingMask mask_{support_, kWidth, kHeight};
  FreshSamples fresh_;
  Cache then_;
};

// Rows are brought by tasks: what one writes must not be what its neighbour still asks for.
TEST(CarryOver, RowsInAnyPiecesLeaveTheSameMemory) {
  for (const bool moves : {true, false}) {
    Frame frame(moves);
    const Frame::Left whole = frame.carried(kHeight);
    for (const int rows : {1, 2, 7, 32}) {
      EXPECT_TRUE(frame.carried(rows) == whole) << rows << " rows at once, moves: " << moves;
    }
    EXPECT_FALSE(whole.forgotten.empty());
  }
}

TEST(CarryOver, WhereNothingMovesOnlyChosenCellsChange) {
  Frame frame(false);
  const Frame::Left left = frame.carried(kHeight);
  std::size_t changed = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * kWidth + x;
      const bool same = left.remembered[at] == frame.then().color(x, y).rgb();
      if (frame.mask().traced(x, y)) {
        changed += same ? 0 : 1;
        EXPECT_GE(left.inverse_depth[at], 0.0F);
      } else {
        EXPECT_TRUE(same) << x << ' ' << y;
        EXPECT_EQ(left.inverse_depth[at], frame.then().inverse_depth(x, y));
      }
    }
  }
  EXPECT_EQ(changed, frame.mask().chosen().size());
}

}  // namespace
}  // namespace macula::kernels::ray
