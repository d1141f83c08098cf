#include "server/scheduling/frame_sharing.h"

#include <atomic>
#include <chrono>
#include <mutex>
#include <utility>

#include "server/scheduling/rank_group.h"
#include "server/scheduling/tile_scheduler.h"
#include "shared/base/check.h"
#include "shared/base/cpu_time.h"

namespace macula::scheduling {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

struct TileCost {
  std::uint32_t tile = 0;
  float cost_ms = 0.0F;
};

/// What a rank tells of its tiles before it hands them over.
struct Summary {
  std::uint64_t payload_bytes = 0;
  std::uint8_t stopped = 0;
  std::vector<TileCost> tiles;

  void carry(Parcel& parcel) {
    parcel.value(payload_bytes);
    parcel.value(stopped);
    parcel.vector(tiles);
  }
};

Summary read_summary(std::span<const std::byte> bytes) {
  Summary summary;
  Parcel parcel = Parcel::unpacking(bytes);
  summary.carry(parcel);
  return summary;
}

}  // namespace

/// What this rank ran of a pass, in the order of its parcel.
struct FrameSharing::Own {
  std::vector<TileCost> tiles;
  std::atomic<bool> left_out{false};

  void run(std::size_t slot, const TileBody& body) {
    const double begin = base::thread_cpu_ms();
    body(tiles[slot].tile);
    tiles[slot].cost_ms = static_cast<float>(base::thread_cpu_ms() - begin);
  }
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
  for (const std::uint32_t tile : tiles) own.tiles.push_back({tile, 0.0F});
  scheduler.run(own.tiles.size(), [&](std::size_t slot) {
    if (!leaves(stop, own)) own.run(slot, body);
  });
}

void FrameSharing::run_by_ticket(TileScheduler& scheduler, const TileBody& body,
                                 const std::stop_token& stop, std::size_t count, Own& own) {
  ranks_.begin_tickets();
  std::mutex mutex;
  std::vector<TileCost> taken;
  scheduler.run(static_cast<std::size_t>(scheduler.threads()), [&](std::size_t) {
    for (;;) {
      if (leaves(stop, own)) return;
      const std::size_t ticket = ranks_.take_ticket();
      if (ticket >= count) return;
      const double begin = base::thread_cpu_ms();
      body(ticket);
      const auto cost = static_cast<float>(base::thread_cpu_ms() - begin);
      std::lock_guard lock(mutex);
      taken.push_back({static_cast<std::uint32_t>(ticket), cost});
    }
  });
  own.tiles = std::move(taken);
}

bool FrameSharing::exchange(const SharedPass& pass, const TileOutputs& outputs, const Own& own,
                            PassRecord& record, bool& stopped) {
  const double begin_pack = base::thread_cpu_ms();
  Bytes& payload = payload_;
  payload.clear();
  Parcel packing = Parcel::packing(payload);
  Summary mine{0, own.left_out.load() ? std::uint8_t{1} : std::uint8_t{0}, own.tiles};
  // Nobody else reads what rank 0 leaves there, nor what one alone does.
  const bool keeps =
      (pass.audience == Audience::RankZero && ranks_.rank() == 0) || ranks_.size() == 1;
  for (const TileCost& tile : own.tiles) {
    if (mine.stopped != 0) break;
    std::size_t weight = payload.size();
    if (keeps) {
      Parcel weighing = Parcel::weighing(weight);
      outputs(tile.tile, weighing);
    } else {
      outputs(tile.tile, packing);
    }
    const std::size_t after = keeps ? weight : payload.size();
    record.bytes[tile.tile] = static_cast<std::uint32_t>(after - (keeps ? payload.size() : weight));
  }
  mine.payload_bytes = payload.size();
  Bytes summary;
  Parcel telling = Parcel::packing(summary);
  mine.carry(telling);
  record.pack_ms += base::thread_cpu_ms() - begin_pack;

  const auto begin = Clock::now();
  const double begin_exchange = base::thread_cpu_ms();
  Gathered summaries;
  if (!ranks_.all_gather(summary, summaries)) return false;
  std::vector<Summary> all;
  std::vector<std::size_t> sizes;
  for (std::size_t rank = 0; rank < summaries.ranks(); ++rank) {
    all.push_back(read_summary(summaries.of(rank)));
    sizes.push_back(all.back().payload_bytes);
  }
  stopped = all.front().stopped != 0;
  if (stopped) return true;
  const bool everyone = pass.audience == Audience::EveryRank;
  const bool receives = everyone || ranks_.rank() == 0;
  Gathered payloads;
  if (receives) payloads = Gathered(sizes);
  if (!(everyone ? ranks_.all_gather(payload, payloads) : ranks_.gather(payload, payloads)))
    return false;
  record.exchange_ms = ms_since(begin);
  record.exchange_cpu_ms = base::thread_cpu_ms() - begin_exchange;
  record.bytes_sent = payload.size();

  const double begin_unpack = base::thread_cpu_ms();
  std::size_t arrived = 0;
  std::vector<bool> seen(pass.tiles.size(), false);
  record.rank_costs_ms.assign(all.size(), 0.0);
  for (std::size_t rank = 0; rank < all.size(); ++rank) {
    const bool other = static_cast<int>(rank) != ranks_.rank();
    std::span<const std::byte> given;
    if (receives && other) given = payloads.of(rank);
    Parcel unpacking = Parcel::unpacking(given);
    record.bytes_received += given.size();
    for (const auto& [tile, cost_ms] : all[rank].tiles) {
      MACULA_CHECK(tile < pass.tiles.size() && !seen[tile], "no tile comes twice");
      seen[tile] = true, ++arrived;
      record.costs_ms[tile] = cost_ms;
      record.rank_costs_ms[rank] += static_cast<double>(cost_ms);
      if (receives && other) outputs(tile, unpacking);
    }
    MACULA_CHECK(unpacking.left() == 0, "a rank sends what its tiles leave behind, and no more");
  }
  MACULA_CHECK(arrived == pass.tiles.size(), "no tile is lost");
  record.pack_ms += base::thread_cpu_ms() - begin_unpack;
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
  if (!exchange(pass, outputs, own, record, stopped) || stopped) return Outcome::Stopped;
  forecast_.learn(pass.tiles, record.costs_ms);
  passes_.push_back(std::move(record));
  return Outcome::Completed;
}

void FrameSharing::pack_rows(const RowTrade& trade, const RowOutputs& outputs, PassRecord& record,
                             std::vector<Bytes>& each) {
  const auto own = static_cast<std::size_t>(ranks_.rank());
  const Rows& mine = trade.makes[own];
  record.bytes.assign(record.costs_ms.size(), 0U);
  for (int y = mine.begin; y < mine.end; ++y) {
    std::size_t weight = 0;
    Parcel weighing = Parcel::weighing(weight);
    outputs(y, weighing);
    record.bytes[static_cast<std::size_t>(y)] = static_cast<std::uint32_t>(weight);
  }
  double spent_ms = 0.0;
  for (const float cost : record.costs_ms) spent_ms += static_cast<double>(cost);
  for (std::size_t rank = 0; rank < each.size(); ++rank) {
    Parcel packing = Parcel::packing(each[rank]);
    packing.value(spent_ms);
    const Rows rows = common(mine, trade.wants[rank]);
    for (int y = rows.begin; rank != own && y < rows.end; ++y) outputs(y, packing);
  }
}

bool FrameSharing::trade(const RowTrade& trade, const RowOutputs& outputs, PassRecord record) {
  const auto own = static_cast<std::size_t>(ranks_.rank());
  const double begin_pack = base::thread_cpu_ms();
  std::vector<Bytes>& each = rows_;
  each.resize(trade.makes.size());
  for (Bytes& bytes : each) bytes.clear();
  pack_rows(trade, outputs, record, each);
  record.pack_ms = base::thread_cpu_ms() - begin_pack;
  const auto begin = Clock::now();
  Gathered from;
  if (!ranks_.trade(each, from)) return false;
  record.exchange_ms = ms_since(begin);
  const double begin_unpack = base::thread_cpu_ms();
  record.exchange_cpu_ms = begin_unpack - begin_pack - record.pack_ms;
  record.over_rows = true;
  record.extra = trade.extra;
  record.rank_costs_ms.assign(each.size(), 0.0);
  for (std::size_t rank = 0; rank < each.size(); ++rank) {
    Parcel unpacking = Parcel::unpacking(from.of(rank));
    unpacking.value(record.rank_costs_ms[rank]);
    if (rank == own) continue;
    record.bytes_sent += each[rank].size(), record.bytes_received += from.of(rank).size();
    const Rows rows = common(trade.makes[rank], trade.wants[own]);
    for (int y = rows.begin; y < rows.end; ++y) outputs(y, unpacking);
    MACULA_CHECK(unpacking.left() == 0, "a rank sends the rows that are read, and no more");
  }
  record.pack_ms += base::thread_cpu_ms() - begin_unpack;
  passes_.push_back(std::move(record));
  return true;
}

bool FrameSharing::tell(const Rows& mine, std::vector<Rows>& all) {
  Bytes said;
  Rows copy = mine;
  Parcel::packing(said).value(copy);
  Gathered heard;
  if (!ranks_.all_gather(said, heard)) return false;
  all.resize(heard.ranks());
  for (std::size_t rank = 0; rank < all.size(); ++rank)
    Parcel::unpacking(heard.of(rank)).value(all[rank]);
  return true;
}

}  // namespace macula::scheduling
