// FrameSharing: one frame's tile passes split among ranks. All ranks run the same kernel on the
// same request and the same history; in a shared pass each runs its own tiles, and what tiles
// leave behind goes to the others (or, where only the finished picture needs it, to rank 0), so
// that after the pass every rank stands where one process alone would stand. Every tile's result
// comes exactly once, or the process ends. What is not shared every rank computes for itself.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/scheduling/balance.h"
#include "server/scheduling/cost_forecast.h"
#include "server/scheduling/parcel.h"
#include "server/scheduling/rows.h"

namespace macula::scheduling {

class RankGroup;
struct Mail;
class TileScheduler;
enum class Outcome;

/// Who needs what the tiles of a pass leave behind.
enum class Audience { EveryRank, RankZero };

/// A pass as its tiles are handed out.
struct SharedPass {
  std::vector<TilePlace> tiles;
  Audience audience = Audience::EveryRank;
};

/// What goes from rank to rank between two steps over rows; by rank.
struct RowTrade {
  int height = 0;
  std::vector<Rows> makes, wants;
  double spent_ms = 0.0;  ///< by this rank on its rows
};
/// What steps over rows cost, by row of the picture.
struct RowStep {
  int reach = 0;  ///< rows on either side of its own that a rank makes for itself
  std::vector<float> costs_ms;
};

/// What one shared pass, or the steps over rows since the last trade, cost, for balance and
/// measurements. Times of this rank, wall; costs, processor time of the threads that ran them.
struct PassRecord {
  std::vector<float> costs_ms;        ///< by tile, of all ranks
  std::vector<float> expected;        ///< by tile
  std::vector<std::uint32_t> bytes;   ///< by tile or row, of what it leaves: of one rank alone all,
                                      ///< else of tiles that were packed
  std::vector<double> rank_costs_ms;  ///< by rank; of rows, this rank's until tell_row_costs()
  double tiles_ms = 0.0;              ///< running this rank's tiles
  double pack_ms = 0.0;               ///< processor time of packing and unpacking
  double exchange_ms = 0.0;           ///< waiting for others included
  double exchange_cpu_ms = 0.0;       ///< processor time of the same, on the calling thread
  std::uint64_t bytes_sent = 0, bytes_received = 0;
  Audience audience = Audience::EveryRank;
  bool over_rows = false;      ///< made in bands (row_bands.h)
  bool asks = false;           ///< ranks told each other first what they read
  std::vector<RowStep> steps;  ///< of one rank alone
  std::vector<Rows> reads;  ///< that the next step reads, by row of a band; empty: the audience all
};

using RowOutputs = std::function<void(int y, Parcel&)>;

class FrameSharing {
 public:
  using TileBody = std::function<void(std::size_t)>;
  using TileOutputs = std::function<void(std::size_t, Parcel&)>;

  /// `forecast` has begun the frame. All must outlive the sharing.
  FrameSharing(RankGroup& ranks, Balance balance, CostForecast& forecast)
      : ranks_(ranks), balance_(balance), forecast_(forecast) {}

  /// Stopped: rank 0's token fired, and all ranks say so of the same pass; or a rank was lost.
  Outcome run(TileScheduler& scheduler, const SharedPass& pass, const TileBody& body,
              const TileOutputs& outputs, const std::stop_token& stop);
  /// Rows change hands. `record` knows audience, reads and steps. False: a rank was lost.
  bool trade(const RowTrade& trade, const RowOutputs& outputs, PassRecord record);
  /// Steps after which none do.
  void note(int height, double spent_ms, PassRecord record);
  /// Every rank learns what each says. False: a rank was lost.
  bool tell(const Rows& mine, std::vector<Rows>& all);
  /// After the last pass, for measurements: every rank learns what each spent on its rows. False: a
  /// rank was lost.
  bool tell_row_costs();
  const std::vector<PassRecord>& passes() const { return passes_; }
  RankGroup& ranks() const { return ranks_; }
  /// Processor time of everything that ran on a scheduler's threads, shared or not.
  double body_ms() const { return body_ms_.load(); }
  void add_body_ms(double took_ms) { body_ms_ += took_ms; }

 private:
  struct Own;
  struct Arrived;
  void run_assigned(TileScheduler& scheduler, const std::vector<std::uint32_t>& tiles,
                    const TileBody& body, const std::stop_token& stop, Own& own);
  /// Whether this pass is to be left; on rank 0, tells the others.
  bool leaves(const std::stop_token& stop, Own& own);
  void run_by_ticket(TileScheduler& scheduler, const TileBody& body, const std::stop_token& stop,
                     std::size_t count, Own& own);
  bool exchange(TileScheduler& scheduler, const SharedPass& pass, const TileOutputs& outputs,
                Own& own, PassRecord& record, bool& stopped);
  void write(const SharedPass& pass, const TileOutputs& outputs, Own& own, PassRecord& record,
             Mail& mail);
  bool read(const SharedPass& pass, PassRecord& record, Mail& mail, std::vector<Arrived>& arrived);
  void write_rows(const RowTrade& trade, const RowOutputs& outputs, PassRecord& record, Mail& mail);
  void read_rows(const RowTrade& trade, const RowOutputs& outputs, PassRecord& record, Mail& mail);
  bool meet(Mail& mail, PassRecord& record);

  RankGroup& ranks_;
  Balance balance_;
  CostForecast& forecast_;
  std::uint64_t pass_ = 0;
  std::atomic<double> body_ms_{0.0};
  std::vector<PassRecord> passes_;
};

}  // namespace macula::scheduling
