// RowBands: a picture's rows in one band a rank, for steps that go over rows and read what lies
// around them. Each rank makes its own band; between steps neighbours lend each other the rows that
// the next one reads, so that no rank needs the whole picture. Bands depend on the height and the
// number of ranks alone. Where the frame is not shared, the one band is the picture and nothing is
// handed over. All ranks call the same functions in the same order.
#pragma once

#include <algorithm>
#include <mutex>
#include <span>
#include <vector>

#include "server/scheduling/frame_sharing.h"
#include "server/scheduling/run_timed.h"
#include "server/scheduling/tile_scheduler.h"

namespace macula::scheduling {

/// Rows of one rank, with `reach` more on either side as far as there are any.
struct Band : Rows {
  int reach = 0;
};

class RowBands {
 public:
  /// Refers to the scheduler.
  RowBands(TileScheduler& scheduler, int height);
  /// Steps after which no rows changed hands are recorded, too.
  ~RowBands();
  RowBands(const RowBands&) = delete;
  RowBands& operator=(const RowBands&) = delete;

  bool is_shared() const { return sharing_ != nullptr; }
  Band own() const { return {of(rank_)}; }
  Band around(int reach) const { return {wide(own(), reach), reach}; }
  Band all() const { return {{0, height_}, height_}; }
  /// body(y) for every row of `rows`, in any order.
  template <class Body>
  Outcome run(const Band& rows, Body&& body) {
    return run_parts(rows, rows_a_task(rows), [&](const Rows& part) {
      for (int y = part.begin; y < part.end; ++y) body(y);
    });
  }
  /// body(part) for `rows` in parts of at most `most`, for what takes several at a time.
  template <class Body>
  Outcome run_parts(const Band& rows, int most, Body&& body) {
    return run_between(rows, rows.begin, most, body);
  }
  /// The same in parts of a picture that is cut every `side` rows from its first.
  template <class Body>
  Outcome run_tile_rows(const Band& rows, int side, Body&& body) {
    return run_between(rows, rows.begin / side * side, side, body);
  }
  /// Of every rank's band, those rows go to others that lie within `reach` of theirs.
  Outcome lend(int reach, const RowOutputs& outputs);
  /// Each rank gets the rows [begin, end) that `reads` names for any of its own.
  Outcome fetch(std::span<const Rows> reads, const RowOutputs& outputs);
  /// Every rank gets all rows, or rank 0 alone.
  Outcome gather(Audience audience, const RowOutputs& outputs);

 private:
  /// Cut every `step` rows from `first` on, which is at most the first of `rows`.
  template <class Body>
  Outcome run_between(const Band& rows, int first, int step, Body&& body) {
    const auto part = [&](std::size_t i) {
      const int begin = first + step * static_cast<int>(i);
      return common(rows, {begin, begin + step});
    };
    const int span = rows.count() > 0 ? rows.end - first : 0;
    const auto count = static_cast<std::size_t>((span + step - 1) / step);
    if (sharing_ == nullptr) return scheduler_.run(count, [&](std::size_t i) { body(part(i)); });
    has_run_ = true;
    run_timed(
        scheduler_, NextPart(count), [&](std::size_t i) { body(part(i)); },
        [&](std::size_t i, double cost_ms) { add_cost(part(i), rows.reach, cost_ms); });
    return Outcome::Completed;
  }
  int rows_a_task(const Rows& rows) const;
  Rows of(int rank) const;
  Rows wide(const Rows& rows, int reach) const;
  void add_cost(const Rows& rows, int reach, double cost_ms);
  Outcome trade(std::vector<Rows> wanted, PassRecord record, const RowOutputs& outputs);

  TileScheduler& scheduler_;
  FrameSharing* sharing_;
  int height_, rank_ = 0, ranks_ = 1;
  bool has_run_ = false;  ///< since the last trade, as on all ranks
  std::mutex mutex_;
  double spent_ms_ = 0.0;       ///< since the last trade
  std::vector<RowStep> steps_;  ///< of one rank alone, since then
};

}  // namespace macula::scheduling
