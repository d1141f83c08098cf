// RowBands: a picture's rows in one band a rank, for steps that go over rows and read what lies
// around them. Each rank makes its own band; between steps neighbours lend each other the rows that
// the next one reads, so that no rank needs the whole picture. Bands depend on the height and the
// number of ranks alone. Where the frame is not shared, the one band is the picture and nothing is
// handed over. All ranks call the same functions in the same order.
#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <vector>

#include "server/scheduling/frame_sharing.h"
#include "server/scheduling/tile_scheduler.h"

namespace macula::scheduling {

class RowBands {
 public:
  /// Refers to the scheduler.
  RowBands(TileScheduler& scheduler, int height);

  bool is_shared() const { return sharing_ != nullptr; }
  Rows own() const { return of(rank_); }
  /// The band with `reach` rows on either side, as far as there are any.
  Rows around(int reach) const { return wide(own(), reach); }
  /// body(y) for every row of `rows`, in any order.
  template <class Body>
  Outcome run(const Rows& rows, Body&& body) {
    return run_parts(rows, rows_a_task(rows), [&](const Rows& part) {
      for (int y = part.begin; y < part.end; ++y) body(y);
    });
  }
  /// body(part) for `rows` in parts of at most `most`, for what takes several at a time.
  template <class Body>
  Outcome run_parts(const Rows& rows, int most, Body&& body) {
    const auto part = [&](std::size_t i) {
      const int begin = rows.begin + most * static_cast<int>(i);
      return Rows{begin, std::min(begin + most, rows.end)};
    };
    const auto count = static_cast<std::size_t>((rows.count() + most - 1) / most);
    if (sharing_ == nullptr) return scheduler_.run(count, [&](std::size_t i) { body(part(i)); });
    extra_ = std::max({extra_, own().begin - rows.begin, rows.end - own().end});
    return scheduler_.run(count, [&](std::size_t i) { run_timed(part(i), body); });
  }
  /// Of every rank's band, those rows go to others that lie within `reach` of theirs.
  Outcome lend(int reach, const RowOutputs& outputs);
  /// Each rank gets the rows [begin, end) that `reads` names for any of its own.
  Outcome fetch(std::span<const Rows> reads, const RowOutputs& outputs);
  /// Every rank gets all rows, or rank 0 alone.
  Outcome gather(Audience audience, const RowOutputs& outputs);

 private:
  int rows_a_task(const Rows& rows) const;
  Rows of(int rank) const;
  Rows wide(const Rows& rows, int reach) const;
  void run_timed(const Rows& rows, const std::function<void(const Rows&)>& body);
  Outcome trade(std::vector<Rows> wanted, PassRecord record, const RowOutputs& outputs);

  TileScheduler& scheduler_;
  FrameSharing* sharing_;
  int height_, rank_ = 0, ranks_ = 1;
  std::vector<float> costs_ms_;  ///< by row, since the last trade
  int extra_ = 0;                ///< rows beyond the band, since then
};

}  // namespace macula::scheduling
