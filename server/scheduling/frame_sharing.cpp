#include "server/scheduling/frame_sharing.h"

#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <utility>

#include "server/scheduling/rank_group.h"
#include "server/scheduling/run_timed.h"
#include "shared/base/check.h"
#include "shared/base/cpu_time.h"

namespace macula::scheduling {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

/// Processor time of this thread between readings.
class CpuLaps {
 public:
  double lap_ms() {
    const double before = std::exchange(last_ms_, base::thread_cpu_ms());
    return last_ms_ - before;
  }

 private:
  double last_ms_ = base::thread_cpu_ms();
};

struct TileCost {
  std::uint32_t tile = 0;
  float cost_ms = 0.0F;
  std::uint32_t bytes = 0;  ///< that follow for it
};

/// What a rank tells of its tiles before what they leave behind.
struct Summary {
  std::uint8_t stopped = 0;
  std::vector<TileCost> tiles;

  void carry(Parcel& parcel) {
    parcel.value(stopped);
    parcel.vector(tiles);
  }
};

}  // namespace

/// What this rank ran of a pass, in the order of its parcel.
struct FrameSharing::Own {
  std::vector<TileCost> tiles;
  std::atomic<bool> left_out{false};
};

bool FrameSharing::leaves(const std::stop_token& stop, Own& own) {
  if (own.left_out.load(std::memory_order_relaxed)) return true;
  const bool is_first = ranks_.rank() == 0;
  if (!(is_first ? stop.stop_requested() : ranks_.hears_stop(pass_))) return false;
  if (!own.left_out.exchange(true) && is_first) ranks_.announce_stop(pass_);
  return true;
}

void FrameSharing::run_assigned(TileScheduler& scheduler, const std::vector<std::uint32_t>& tiles,
                                const TileBody& body, const std::stop_token& stop, Own& own) {
  for (const std::uint32_t tile : tiles) own.tiles.push_back({tile});
  NextPart next(tiles.size());
  run_timed(
      scheduler, [&] { return leaves(stop, own) ? std::nullopt : next(); },
      [&](std::size_t slot) { body(tiles[slot]); },
      [&](std::size_t slot, double cost_ms) {
        own.tiles[slot].cost_ms = static_cast<float>(cost_ms);
      });
}

void FrameSharing::run_by_ticket(TileScheduler& scheduler, const TileBody& body,
                                 const std::stop_token& stop, std::size_t count, Own& own) {
  ranks_.begin_tickets();
  std::mutex mutex;
  const auto take = [&]() -> std::optional<std::size_t> {
    if (leaves(stop, own)) return std::nullopt;
    const std::size_t ticket = ranks_.take_ticket();
    return ticket < count ? std::optional(ticket) : std::nullopt;
  };
  run_timed(scheduler, take, body, [&](std::size_t tile, double cost_ms) {
    std::lock_guard lock(mutex);
    own.tiles.push_back({static_cast<std::uint32_t>(tile), static_cast<float>(cost_ms)});
  });
}

/// A message begins with the summary; what tiles leave follows for those who need it.
void FrameSharing::write(const SharedPass& pass, const TileOutputs& outputs, Own& own,
                         PassRecord& record, Mail& mail) {
  const auto rank = static_cast<std::size_t>(ranks_.rank());
  const bool everyone = pass.audience == Audience::EveryRank;
  Bytes& message = mail.written[rank];
  Parcel packing = Parcel::packing(message);
  Summary mine{own.left_out.load() ? std::uint8_t{1} : std::uint8_t{0}, std::move(own.tiles)};
  mine.carry(packing);
  const std::size_t summary = message.size();
  // Nobody else reads what rank 0 leaves for itself.
  const bool sends = ranks_.size() > 1 && (everyone || rank != 0) && mine.stopped == 0;
  for (TileCost& tile : mine.tiles) {
    std::size_t weight = 0;
    if (sends) {
      const std::size_t before = message.size();
      outputs(tile.tile, packing);
      weight = message.size() - before;
      tile.bytes = static_cast<std::uint32_t>(weight);
    } else if (ranks_.size() == 1) {
      Parcel weighing = Parcel::weighing(weight);
      outputs(tile.tile, weighing);
    }
    record.bytes[tile.tile] = static_cast<std::uint32_t>(weight);
  }
  Bytes again;  // now that it knows the bytes
  Parcel correcting = Parcel::packing(again);
  mine.carry(correcting);
  std::ranges::copy(again, message.begin());
  record.bytes_sent = message.size() - summary;
  for (std::size_t other = 0; other < mail.to.size(); ++other) {
    if (other == rank) continue;
    mail.to[other] = std::span(message).first(everyone || other == 0 ? message.size() : summary);
    mail.comes[other] = true;
  }
}

/// Where a tile's parcel lies in a message.
struct FrameSharing::Arrived {
  std::uint32_t tile = 0;
  std::span<const std::byte> bytes;
};

/// True: all ranks left the pass.
bool FrameSharing::read(const SharedPass& pass, PassRecord& record, Mail& mail,
                        std::vector<Arrived>& arrived) {
  const auto rank = static_cast<std::size_t>(ranks_.rank());
  const bool receives = pass.audience == Audience::EveryRank || rank == 0;
  std::vector<bool> seen(pass.tiles.size(), false);
  std::size_t tiles = 0;
  record.rank_costs_ms.assign(mail.from.size(), 0.0);
  for (std::size_t from = 0; from < mail.from.size(); ++from) {
    const Bytes& message = from == rank ? mail.written[rank] : mail.from[from];
    Parcel parcel = Parcel::unpacking(message);
    Summary summary;
    summary.carry(parcel);
    if (from == 0 && summary.stopped != 0) return true;
    auto left = std::span(message).last(parcel.left());
    if (from != rank && receives) record.bytes_received += left.size();
    for (const TileCost& each : summary.tiles) {
      MACULA_CHECK(each.tile < pass.tiles.size() && !seen[each.tile], "no tile comes twice");
      seen[each.tile] = true, ++tiles;
      record.costs_ms[each.tile] = each.cost_ms;
      record.rank_costs_ms[from] += static_cast<double>(each.cost_ms);
      if (from == rank || !receives) continue;
      MACULA_CHECK(each.bytes <= left.size(), "a rank sends what its tiles leave behind");
      arrived.push_back({each.tile, left.first(each.bytes)});
      left = left.subspan(each.bytes);
    }
    MACULA_CHECK(from == rank || !receives || left.empty(), "and no more");
  }
  MACULA_CHECK(tiles == pass.tiles.size(), "no tile is lost");
  return false;
}

bool FrameSharing::exchange(TileScheduler& scheduler, const SharedPass& pass,
                            const TileOutputs& outputs, Own& own, PassRecord& record,
                            bool& stopped) {
  Mail& mail = ranks_.new_mail();
  CpuLaps laps;
  write(pass, outputs, own, record, mail);
  record.pack_ms = laps.lap_ms();
  if (!meet(mail, record)) return false;
  laps.lap_ms();
  std::vector<Arrived> arrived;
  stopped = read(pass, record, mail, arrived);
  if (stopped) return true;
  scheduler.run(arrived.size(), [&](std::size_t i) {
    Parcel parcel = Parcel::unpacking(arrived[i].bytes);
    outputs(arrived[i].tile, parcel);
    MACULA_CHECK(parcel.left() == 0, "a tile's parcel holds what its description says");
  });
  record.pack_ms += laps.lap_ms();
  return true;
}

/// What it took is recorded.
bool FrameSharing::meet(Mail& mail, PassRecord& record) {
  const auto begin = Clock::now();
  const double begin_cpu_ms = base::thread_cpu_ms();
  if (!ranks_.trade(mail)) return false;
  record.exchange_ms = ms_since(begin);
  record.exchange_cpu_ms = base::thread_cpu_ms() - begin_cpu_ms;
  return true;
}

Outcome FrameSharing::run(TileScheduler& scheduler, const SharedPass& pass, const TileBody& body,
                          const TileOutputs& outputs, const std::stop_token& stop) {
  const std::size_t count = pass.tiles.size();
  PassRecord record;
  record.audience = pass.audience;
  record.expected = forecast_.expect(pass.tiles);
  record.costs_ms.assign(count, 0.0F);
  record.bytes.assign(count, 0U);
  const auto begin = Clock::now();
  pass_ = ranks_.begin_pass();
  Own own;
  if (balance_ == Balance::Dynamic) {
    run_by_ticket(scheduler, body, stop, count, own);
  } else {
    const auto tiles = balance_ == Balance::Predicted
                           ? assign_by_cost(record.expected, ranks_.size())
                           : assign_stripes(count, ranks_.size());
    run_assigned(scheduler, tiles[static_cast<std::size_t>(ranks_.rank())], body, stop, own);
  }
  record.tiles_ms = ms_since(begin);
  bool stopped = false;
  if (!exchange(scheduler, pass, outputs, own, record, stopped) || stopped) return Outcome::Stopped;
  forecast_.learn(pass.tiles, record.costs_ms);
  passes_.push_back(std::move(record));
  return Outcome::Completed;
}

/// Rows that others read, written for each; and what all weigh, where nobody else takes part.
void FrameSharing::write_rows(const RowTrade& trade, const RowOutputs& outputs, PassRecord& record,
                              Mail& mail) {
  const auto own = static_cast<std::size_t>(ranks_.rank());
  const Rows& mine = trade.makes[own];
  record.bytes.assign(static_cast<std::size_t>(trade.height), 0U);
  for (int y = mine.begin; ranks_.size() == 1 && y < mine.end; ++y) {
    std::size_t weight = 0;
    Parcel weighing = Parcel::weighing(weight);
    outputs(y, weighing);
    record.bytes[static_cast<std::size_t>(y)] = static_cast<std::uint32_t>(weight);
  }
  for (std::size_t rank = 0; rank < mail.to.size(); ++rank) {
    const Rows rows = common(mine, trade.wants[rank]);
    if (rank == own || rows.count() == 0) continue;
    Parcel packing = Parcel::packing(mail.written[rank]);
    for (int y = rows.begin; y < rows.end; ++y) outputs(y, packing);
    mail.to[rank] = mail.written[rank];
    record.bytes_sent += mail.written[rank].size();
  }
}

void FrameSharing::read_rows(const RowTrade& trade, const RowOutputs& outputs, PassRecord& record,
                             Mail& mail) {
  const auto own = static_cast<std::size_t>(ranks_.rank());
  for (std::size_t rank = 0; rank < mail.from.size(); ++rank) {
    if (!mail.comes[rank]) continue;
    record.bytes_received += mail.from[rank].size();
    Parcel unpacking = Parcel::unpacking(mail.from[rank]);
    const Rows rows = common(trade.makes[rank], trade.wants[own]);
    for (int y = rows.begin; y < rows.end; ++y) outputs(y, unpacking);
    MACULA_CHECK(unpacking.left() == 0, "a rank sends the rows that are read, and no more");
  }
}

bool FrameSharing::trade(const RowTrade& trade, const RowOutputs& outputs, PassRecord record) {
  const auto own = static_cast<std::size_t>(ranks_.rank());
  record.over_rows = true;
  record.rank_costs_ms.assign(trade.makes.size(), 0.0);
  record.rank_costs_ms[own] = trade.spent_ms;
  Mail& mail = ranks_.new_mail();
  for (std::size_t rank = 0; rank < mail.comes.size(); ++rank)
    mail.comes[rank] = rank != own && common(trade.makes[rank], trade.wants[own]).count() > 0;
  CpuLaps laps;
  write_rows(trade, outputs, record, mail);
  record.pack_ms = laps.lap_ms();
  if (!meet(mail, record)) return false;
  laps.lap_ms();
  read_rows(trade, outputs, record, mail);
  record.pack_ms += laps.lap_ms();
  passes_.push_back(std::move(record));
  return true;
}

void FrameSharing::note(int height, double spent_ms, PassRecord record) {
  const auto rows = static_cast<std::size_t>(height);
  record.over_rows = true;
  record.bytes.assign(rows, 0U);
  record.reads.assign(rows, Rows{});
  record.rank_costs_ms.assign(static_cast<std::size_t>(ranks_.size()), 0.0);
  record.rank_costs_ms[static_cast<std::size_t>(ranks_.rank())] = spent_ms;
  passes_.push_back(std::move(record));
}

bool FrameSharing::tell(const Rows& mine, std::vector<Rows>& all) {
  Bytes said;
  Rows copy = mine;
  Parcel::packing(said).value(copy);
  std::vector<Bytes> heard;
  if (!ranks_.all_gather(said, heard)) return false;
  all.resize(heard.size());
  for (std::size_t rank = 0; rank < all.size(); ++rank)
    Parcel::unpacking(heard[rank]).value(all[rank]);
  return true;
}

bool FrameSharing::tell_row_costs() {
  const auto own = static_cast<std::size_t>(ranks_.rank());
  std::vector<double> mine;
  for (const PassRecord& pass : passes_)
    if (pass.over_rows) mine.push_back(pass.rank_costs_ms[own]);
  Bytes said;
  Parcel::packing(said).values(std::span(mine));
  std::vector<Bytes> heard;
  if (!ranks_.all_gather(said, heard)) return false;
  for (std::size_t rank = 0; rank < heard.size(); ++rank) {
    Parcel parcel = Parcel::unpacking(heard[rank]);
    for (PassRecord& pass : passes_)
      if (pass.over_rows) parcel.value(pass.rank_costs_ms[rank]);
  }
  return true;
}

}  // namespace macula::scheduling
