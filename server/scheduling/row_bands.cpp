#include "server/scheduling/row_bands.h"

#include <algorithm>
#include <utility>

#include "server/scheduling/rank_group.h"

namespace macula::scheduling {

RowBands::RowBands(TileScheduler& scheduler, int height)
    : scheduler_(scheduler), sharing_(scheduler.sharing()), height_(height) {
  if (sharing_ == nullptr) return;
  rank_ = sharing_->ranks().rank(), ranks_ = sharing_->ranks().size();
}

/// Parts that are timed take several rows, few enough that threads end together.
int RowBands::rows_a_task(const Rows& rows) const {
  constexpr int kTasksAThread = 4, kMost = 16;
  if (sharing_ == nullptr) return 1;
  return std::clamp(rows.count() / (kTasksAThread * scheduler_.threads()), 1, kMost);
}

RowBands::~RowBands() {
  if (!has_run_) return;
  PassRecord record;
  record.steps = std::move(steps_);
  sharing_->note(height_, spent_ms_, std::move(record));
}

Rows RowBands::of(int rank) const {
  const auto edge = [&](int k) {
    return static_cast<int>(static_cast<std::int64_t>(height_) * k / ranks_);
  };
  return {edge(rank), edge(rank + 1)};
}

Rows RowBands::wide(const Rows& rows, int reach) const {
  if (rows.count() == 0) return rows;
  return {std::max(rows.begin - reach, 0), std::min(rows.end + reach, height_)};
}

void RowBands::add_cost(const Rows& rows, int reach, double cost_ms) {
  std::lock_guard lock(mutex_);
  spent_ms_ += cost_ms;
  if (ranks_ > 1) return;
  auto step = std::ranges::find(steps_, reach, &RowStep::reach);
  if (step == steps_.end()) {
    steps_.push_back({reach, std::vector<float>(static_cast<std::size_t>(height_), 0.0F)});
    step = steps_.end() - 1;
  }
  for (int y = rows.begin; y < rows.end; ++y)
    step->costs_ms[static_cast<std::size_t>(y)] += static_cast<float>(cost_ms / rows.count());
}

Outcome RowBands::lend(int reach, const RowOutputs& outputs) {
  if (sharing_ == nullptr) return Outcome::Completed;
  std::vector<Rows> wanted;
  for (int rank = 0; rank < ranks_; ++rank) wanted.push_back(wide(of(rank), reach));
  PassRecord record;
  for (int y = 0; y < height_; ++y) record.reads.push_back(wide({y, y + 1}, reach));
  return trade(std::move(wanted), std::move(record), outputs);
}

Outcome RowBands::fetch(std::span<const Rows> reads, const RowOutputs& outputs) {
  if (sharing_ == nullptr) return Outcome::Completed;
  Rows mine;
  for (const Rows& rows : reads) mine = span_of(mine, rows);
  std::vector<Rows> wanted;
  if (!sharing_->tell(mine, wanted)) return Outcome::Stopped;
  PassRecord record;
  record.asks = true;
  record.reads.resize(static_cast<std::size_t>(height_));
  const std::size_t first = static_cast<std::size_t>(own().begin);
  for (std::size_t i = 0; i < reads.size() && first + i < record.reads.size(); ++i)
    record.reads[first + i] = reads[i];
  return trade(std::move(wanted), std::move(record), outputs);
}

Outcome RowBands::gather(Audience audience, const RowOutputs& outputs) {
  if (sharing_ == nullptr) return Outcome::Completed;
  std::vector<Rows> wanted(static_cast<std::size_t>(ranks_));
  const bool everyone = audience == Audience::EveryRank;
  for (std::size_t rank = 0; rank < wanted.size(); ++rank)
    if (everyone || rank == 0) wanted[rank] = {0, height_};
  PassRecord record;
  record.audience = audience;
  return trade(std::move(wanted), std::move(record), outputs);
}

Outcome RowBands::trade(std::vector<Rows> wanted, PassRecord record, const RowOutputs& outputs) {
  RowTrade trade{height_, {}, std::move(wanted), std::exchange(spent_ms_, 0.0)};
  for (int rank = 0; rank < ranks_; ++rank) trade.makes.push_back(of(rank));
  record.steps = std::exchange(steps_, {});
  has_run_ = false;
  return sharing_->trade(trade, outputs, std::move(record)) ? Outcome::Completed : Outcome::Stopped;
}

}  // namespace macula::scheduling
