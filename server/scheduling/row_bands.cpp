#include "server/scheduling/row_bands.h"

#include <algorithm>
#include <utility>

#include "server/scheduling/rank_group.h"
#include "shared/base/cpu_time.h"

namespace macula::scheduling {

RowBands::RowBands(TileScheduler& scheduler, int height)
    : scheduler_(scheduler), sharing_(scheduler.sharing()), height_(height) {
  if (sharing_ == nullptr) return;
  rank_ = sharing_->ranks().rank(), ranks_ = sharing_->ranks().size();
  costs_ms_.assign(static_cast<std::size_t>(height), 0.0F);
}

/// Reading a thread's CPU clock is a system call, about as long as a short step's row: tasks that
/// are timed take several, few enough that threads end together.
int RowBands::rows_a_task(const Rows& rows) const {
  constexpr int kTasksAThread = 4, kMost = 16;
  if (sharing_ == nullptr) return 1;
  return std::clamp(rows.count() / (kTasksAThread * scheduler_.threads()), 1, kMost);
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

void RowBands::run_timed(const Rows& rows, const std::function<void(const Rows&)>& body) {
  const double begin = base::thread_cpu_ms();
  body(rows);
  const double each_ms = (base::thread_cpu_ms() - begin) / rows.count();
  for (int y = rows.begin; y < rows.end; ++y)
    costs_ms_[static_cast<std::size_t>(y)] += static_cast<float>(each_ms);
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
  RowTrade trade{{}, std::move(wanted), extra_};
  for (int rank = 0; rank < ranks_; ++rank) trade.makes.push_back(of(rank));
  record.costs_ms = std::exchange(costs_ms_, std::vector<float>(costs_ms_.size(), 0.0F));
  extra_ = 0;
  return sharing_->trade(trade, outputs, std::move(record)) ? Outcome::Completed : Outcome::Stopped;
}

}  // namespace macula::scheduling
