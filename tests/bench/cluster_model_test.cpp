// Closed forms of the modelled cluster.
#include "tests/bench/cluster_model.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace macula::bench {
namespace {

using scheduling::Audience;
using scheduling::Balance;

/// 64 tiles of 1 ms that leave 1000 bytes each.
FrameTrace even_tiles(Audience audience) {
  scheduling::PassRecord pass;
  pass.costs_ms.assign(64, 1.0F);
  pass.expected.assign(64, 1.0F);
  pass.bytes.assign(64, 1000U);
  pass.audience = audience;
  return {{pass}, 2.0, 0.0};
}

TEST(ClusterModel, OneRankTakesTheTilesAndWhatIsAlone) {
  const ModelledFrame one = model_frame(even_tiles(Audience::EveryRank), {}, Balance::Predicted);
  EXPECT_DOUBLE_EQ(one.frame_ms, 66.0);
  EXPECT_EQ(one.comm_bytes, 0.0);
  EXPECT_EQ(one.imbalance, 1.0);
}

TEST(ClusterModel, EightRanksShareTilesAndPayForLinksAndCopies) {
  const ClusterSpec spec{8, 1, 0.1, 0.01, 1000.0, 2000.0};
  const ModelledFrame all = model_frame(even_tiles(Audience::EveryRank), spec, Balance::Predicted);
  EXPECT_DOUBLE_EQ(all.tiles_ms, 8.0);
  EXPECT_DOUBLE_EQ(all.alone_ms, 2.0);
  EXPECT_DOUBLE_EQ(all.copy_ms, (8000.0 + 56000.0) / 2000.0);
  EXPECT_DOUBLE_EQ(all.transfer_ms, 0.1 + 7 * 0.01 + 56000.0 / 1000.0);
  EXPECT_DOUBLE_EQ(all.comm_bytes, 7 * 64000.0);
  const ModelledFrame zero = model_frame(even_tiles(Audience::RankZero), spec, Balance::Predicted);
  EXPECT_DOUBLE_EQ(zero.comm_bytes, 56000.0);
}

TEST(ClusterModel, ThreadsOfARankShareItsTiles) {
  const ClusterSpec spec{2, 16, 0.0, 0.0, 1e12, 1e12};
  const ModelledFrame frame = model_frame(even_tiles(Audience::RankZero), spec, Balance::Predicted);
  EXPECT_DOUBLE_EQ(frame.tiles_ms, 2.0);
  const ClusterSpec copying{2, 16, 0.0, 0.0, 1e12, 1000.0};
  EXPECT_DOUBLE_EQ(
      model_frame(even_tiles(Audience::EveryRank), copying, Balance::Predicted).copy_ms,
      32.0 + 32.0 / 16.0);
}

TEST(ClusterModel, StripesWaitForTheCostlyPart) {
  FrameTrace trace = even_tiles(Audience::RankZero);
  for (std::size_t tile = 0; tile < 16; ++tile)
    trace.passes[0].costs_ms[tile] = trace.passes[0].expected[tile] = 10.0F;
  const ClusterSpec spec{4, 1, 0.0, 0.0, 1e12, 1e12};
  EXPECT_GT(model_frame(trace, spec, Balance::Stripes).imbalance, 3.0);
  EXPECT_LE(model_frame(trace, spec, Balance::Predicted).imbalance, 1.02);
  EXPECT_LE(model_frame(trace, spec, Balance::Dynamic).imbalance, 1.1);
}

/// 64 rows of 1 ms, 1000 bytes each; the next step reads four to either side.
TEST(ClusterModel, BandsOfRowsPayForTheRowsBesideThemAlone) {
  FrameTrace trace = even_tiles(Audience::EveryRank);
  scheduling::PassRecord& rows = trace.passes[0];
  rows.over_rows = true;
  rows.steps = {{0, std::vector<float>(64, 1.0F)}};
  for (int y = 0; y < 64; ++y) rows.reads.push_back({std::max(y - 4, 0), std::min(y + 5, 64)});
  const ClusterSpec spec{8, 1, 0.1, 0.01, 1000.0, 2000.0};
  const ModelledFrame lent = model_frame(trace, spec, Balance::Predicted);
  EXPECT_DOUBLE_EQ(lent.tiles_ms, 8.0);
  EXPECT_DOUBLE_EQ(lent.comm_bytes, 7 * 2 * 4000.0);
  EXPECT_DOUBLE_EQ(lent.copy_ms, (8000.0 + 8000.0) / 2000.0);
  EXPECT_DOUBLE_EQ(lent.transfer_ms, 0.1 + 2 * 0.01 + 8000.0 / 1000.0);
  rows.asks = true;
  EXPECT_DOUBLE_EQ(model_frame(trace, spec, Balance::Predicted).transfer_ms,
                   lent.transfer_ms + 0.1 + 7 * 0.01);
  rows.steps[0].reach = 2;
  EXPECT_DOUBLE_EQ(model_frame(trace, spec, Balance::Predicted).tiles_ms, 12.0);
  rows.reads.clear();
  EXPECT_DOUBLE_EQ(model_frame(trace, spec, Balance::Predicted).comm_bytes, 7 * 64000.0);
}

TEST(ClusterModel, WhatARankDoesAloneOnItsThreadsShrinksWithThem) {
  FrameTrace trace = even_tiles(Audience::RankZero);
  trace.threaded_ms = 16.0;
  EXPECT_DOUBLE_EQ(model_frame(trace, {1, 4, 0.0, 0.0, 1e12, 1e12}, Balance::Predicted).alone_ms,
                   6.0);
}

}  // namespace
}  // namespace macula::bench
