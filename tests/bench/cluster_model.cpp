#include "tests/bench/cluster_model.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>

namespace macula::bench {
namespace {

using scheduling::Audience;
using scheduling::Balance;
using scheduling::PassRecord;

/// Free processors, the earliest first.
using Processors = std::priority_queue<double, std::vector<double>, std::greater<>>;

Processors idle(int count) {
  Processors processors;
  for (int i = 0; i < count; ++i) processors.push(0.0);
  return processors;
}

/// What one rank does of a pass.
struct Share {
  double cost_ms = 0.0;  ///< of all its tiles
  double until_ms = 0.0;
  double bytes = 0.0;
};

Share share_of(const PassRecord& pass, const std::vector<std::uint32_t>& tiles, int threads) {
  Share share;
  Processors processors = idle(threads);
  for (const std::uint32_t tile : tiles) {
    const double end = processors.top() + static_cast<double>(pass.costs_ms[tile]);
    processors.pop();
    processors.push(end);
    share.cost_ms += static_cast<double>(pass.costs_ms[tile]);
    share.until_ms = std::max(share.until_ms, end);
    share.bytes += pass.bytes[tile];
  }
  return share;
}

std::vector<Share> shares_by_ticket(const PassRecord& pass, const ClusterSpec& spec) {
  std::vector<Share> shares(static_cast<std::size_t>(spec.ranks));
  using Worker = std::pair<double, std::size_t>;
  std::priority_queue<Worker, std::vector<Worker>, std::greater<>> workers;
  for (std::size_t rank = 0; rank < shares.size(); ++rank)
    for (int thread = 0; thread < spec.threads; ++thread) workers.emplace(0.0, rank);
  for (std::size_t tile = 0; tile < pass.costs_ms.size(); ++tile) {
    const auto [free_at, rank] = workers.top();
    workers.pop();
    const double asking = rank == 0 ? 0.0 : 2.0 * spec.latency_ms;
    const double end = free_at + asking + static_cast<double>(pass.costs_ms[tile]);
    workers.emplace(end, rank);
    shares[rank].cost_ms += static_cast<double>(pass.costs_ms[tile]);
    shares[rank].until_ms = std::max(shares[rank].until_ms, end);
    shares[rank].bytes += pass.bytes[tile];
  }
  return shares;
}

std::vector<Share> shares_of(const PassRecord& pass, const ClusterSpec& spec, Balance balance) {
  if (balance == Balance::Dynamic) return shares_by_ticket(pass, spec);
  const auto tiles = balance == Balance::Predicted
                         ? scheduling::assign_by_cost(pass.expected, spec.ranks)
                         : scheduling::assign_stripes(pass.costs_ms.size(), spec.ranks);
  std::vector<Share> shares;
  for (const auto& own : tiles) shares.push_back(share_of(pass, own, spec.threads));
  return shares;
}

/// Equal bands: which one a row belongs to, and where it begins.
scheduling::Rows band_of(std::size_t rank, int ranks, std::size_t height) {
  const auto edge = [&](std::size_t k) {
    return static_cast<int>(height * k / static_cast<std::size_t>(ranks));
  };
  return {edge(rank), edge(rank + 1)};
}

/// What one rank does of a step over rows, and the bytes that come to it from others.
struct BandShare {
  Share made;
  double received = 0.0;
  double senders = 0.0;  ///< ranks from which they come
};

double bytes_of(const PassRecord& pass, const scheduling::Rows& rows) {
  double bytes = 0.0;
  for (int y = rows.begin; y < rows.end; ++y) bytes += pass.bytes[static_cast<std::size_t>(y)];
  return bytes;
}

/// Of a step, the rows that a rank makes: its own and those within reach.
std::vector<float> made_of(const scheduling::RowStep& step, const scheduling::Rows& own) {
  if (own.count() == 0) return {};
  const auto height = static_cast<int>(step.costs_ms.size());
  const int begin = std::max(own.begin - step.reach, 0);
  const int end = std::min(own.end + step.reach, height);
  return {step.costs_ms.begin() + begin, step.costs_ms.begin() + end};
}

BandShare band_share(const PassRecord& pass, std::size_t rank, const ClusterSpec& spec) {
  const auto height = static_cast<int>(pass.bytes.size());
  const scheduling::Rows own = band_of(rank, spec.ranks, pass.bytes.size());
  BandShare share;
  for (const scheduling::RowStep& step : pass.steps) {
    const std::vector<float> rows = made_of(step, own);
    const double cost_ms = std::reduce(rows.begin(), rows.end(), 0.0);
    share.made.cost_ms += cost_ms;
    share.made.until_ms += cost_ms / spec.threads;
  }
  share.made.bytes = bytes_of(pass, own);
  scheduling::Rows read;
  for (int y = own.begin; y < own.end && !pass.reads.empty(); ++y)
    read = span_of(read, pass.reads[static_cast<std::size_t>(y)]);
  const bool reads_all = pass.audience == Audience::EveryRank || rank == 0;
  if (pass.reads.empty() && reads_all) read = {0, height};
  share.received = bytes_of(pass, read) - bytes_of(pass, common(read, own));
  for (std::size_t other = 0; other < static_cast<std::size_t>(spec.ranks); ++other)
    if (other != rank && common(read, band_of(other, spec.ranks, pass.bytes.size())).count() > 0)
      ++share.senders;
  return share;
}

/// In which a rank hears from that many.
double meeting_ms(const ClusterSpec& spec, double senders) {
  return senders > 0.0 ? spec.latency_ms + senders * spec.message_ms : 0.0;
}

void add_rows(const PassRecord& pass, const ClusterSpec& spec, ModelledFrame& frame,
              double& slowest, double& mean) {
  Share most;
  double cost = 0.0, received = 0.0, most_received = 0.0, senders = 0.0;
  for (std::size_t rank = 0; rank < static_cast<std::size_t>(spec.ranks); ++rank) {
    const BandShare share = band_share(pass, rank, spec);
    most.cost_ms = std::max(most.cost_ms, share.made.cost_ms);
    most.until_ms = std::max(most.until_ms, share.made.until_ms);
    most.bytes = std::max(most.bytes, share.made.bytes);
    most_received = std::max(most_received, share.received);
    senders = std::max(senders, share.senders);
    cost += share.made.cost_ms, received += share.received;
  }
  frame.tiles_ms += most.until_ms;
  slowest += most.cost_ms, mean += cost / spec.ranks;
  if (spec.ranks == 1) return;
  frame.copy_ms += (std::min(most.bytes, most_received) + most_received) / spec.copied_bytes_per_ms;
  if (pass.asks) frame.transfer_ms += meeting_ms(spec, spec.ranks - 1);
  frame.transfer_ms += meeting_ms(spec, senders) + most_received / spec.bytes_per_ms;
  frame.comm_bytes += received;
}

}  // namespace

ModelledFrame model_frame(const FrameTrace& trace, const ClusterSpec& spec, Balance balance) {
  ModelledFrame frame;
  frame.alone_ms = trace.alone_ms + trace.threaded_ms / spec.threads;
  const double ranks = spec.ranks;
  double slowest = 0.0, mean = 0.0;
  for (const PassRecord& pass : trace.passes) {
    if (pass.over_rows) {
      add_rows(pass, spec, frame, slowest, mean);
      continue;
    }
    const std::vector<Share> shares = shares_of(pass, spec, balance);
    Share most;
    double cost = 0.0, bytes = 0.0;
    for (const Share& share : shares) {
      most.cost_ms = std::max(most.cost_ms, share.cost_ms);
      most.until_ms = std::max(most.until_ms, share.until_ms);
      most.bytes = std::max(most.bytes, share.bytes);
      cost += share.cost_ms, bytes += share.bytes;
    }
    frame.tiles_ms += most.until_ms;
    slowest += most.cost_ms, mean += cost / ranks;
    if (spec.ranks == 1) continue;
    // Rank 0 keeps what it has where nobody else reads it.
    const bool everyone = pass.audience == Audience::EveryRank;
    const double received = bytes - (everyone ? bytes / ranks : shares.front().bytes);
    frame.copy_ms += (most.bytes + received / spec.threads) / spec.copied_bytes_per_ms;
    frame.transfer_ms += meeting_ms(spec, ranks - 1.0) + received / spec.bytes_per_ms;
    frame.comm_bytes += everyone ? bytes * (ranks - 1.0) : received;
  }
  if (mean > 0.0) frame.imbalance = slowest / mean;
  frame.frame_ms = frame.tiles_ms + frame.alone_ms + frame.copy_ms + frame.transfer_ms;
  return frame;
}

}  // namespace macula::bench
