#include "tests/bench/scaling.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

#include "server/cluster/mpi/mpi_ranks.h"
#include "server/cluster/one_rank.h"
#include "shared/base/text.h"
#include "tests/bench/arguments.h"
#include "tests/bench/cluster_model.h"
#include "tests/bench/progress.h"
#include "tests/bench/report.h"
#include "tests/bench/scaling_setting.h"

namespace macula::bench {
namespace {

using cluster::SharedFrame;
using scheduling::Balance;
using Group = std::shared_ptr<scheduling::RankGroup>;

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Of rank 0's tiles and rows.
double own_costs_ms(const SharedFrame& frame) {
  double own = 0.0;
  for (const scheduling::PassRecord& pass : frame.passes) own += pass.rank_costs_ms.front();
  return own;
}

/// Of one rank's processor: what it did besides its own tiles and waiting.
double alone_ms(const SharedFrame& frame) {
  double exchange = 0.0, packing = 0.0;
  for (const scheduling::PassRecord& pass : frame.passes)
    exchange += pass.exchange_cpu_ms, packing += pass.pack_ms;
  return frame.cpu_ms - own_costs_ms(frame) - exchange - packing;
}

/// The part of it that runs on all of a rank's threads.
double threaded_ms(const SharedFrame& frame) {
  return std::clamp(frame.threaded_ms - own_costs_ms(frame), 0.0, alone_ms(frame));
}

/// What a series of frames took, as rank 0 saw it.
struct Measured {
  std::vector<double> frame_ms, path_ms, imbalance, comm_bytes;
  double packed_bytes = 0.0, pack_ms = 0.0;

  void add(const SharedFrame& frame, int ranks) {
    double slowest = 0.0, mean = 0.0, bytes = 0.0, packing = 0.0;
    for (const scheduling::PassRecord& pass : frame.passes) {
      slowest += std::ranges::max(pass.rank_costs_ms);
      mean += std::reduce(pass.rank_costs_ms.begin(), pass.rank_costs_ms.end()) / ranks;
      const bool everyone = pass.audience == scheduling::Audience::EveryRank;
      const auto all = static_cast<double>(pass.bytes_sent + pass.bytes_received);
      // Of steps over rows, what rank 0 handed over and got; with two ranks, that is all.
      bytes += pass.over_rows ? all
               : everyone     ? all * (ranks - 1)
                              : static_cast<double>(pass.bytes_received);
      packing += ranks > 1 ? pass.pack_ms : 0.0;  // one rank only weighs
      packed_bytes += all;
    }
    pack_ms += packing;
    frame_ms.push_back(frame.frame_ms);
    path_ms.push_back(slowest + alone_ms(frame) + packing);
    imbalance.push_back(mean > 0.0 ? slowest / mean : 1.0);
    comm_bytes.push_back(bytes);
  }
};

struct Link {
  double latency_ms = 0.0, bytes_per_ms = 0.0;
};

/// Between the ranks as they are: of a byte, and of many.
Link measure_link(scheduling::RankGroup& ranks) {
  const auto time_ms = [&](std::size_t bytes, int times) {
    const scheduling::Bytes mine(bytes);
    std::vector<double> each;
    for (int i = 0; i < times; ++i) {
      scheduling::Mail& mail = ranks.new_mail();
      for (std::size_t other = 0; other < mail.to.size(); ++other) {
        if (static_cast<int>(other) == ranks.rank()) continue;
        mail.to[other] = mine, mail.comes[other] = true;
      }
      const auto begin = std::chrono::steady_clock::now();
      if (!ranks.trade(mail)) break;
      each.push_back(
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
              .count());
    }
    return median(each);
  };
  constexpr std::size_t kMany = 4U << 20U;
  const double small = time_ms(1, 200), large = time_ms(kMany, 15);
  return {small, static_cast<double>(kMany) * (ranks.size() - 1) / (large - small)};
}

class Experiment {
 public:
  Experiment(const ScalingOptions& options, std::shared_ptr<cluster::MpiRanks> world)
      : options_(options), world_(std::move(world)), scheduler_(options.threads) {
    if (!world_) {
      groups_ = {std::make_shared<cluster::OneRank>()};
      return;
    }
    for (int ranks = 1; ranks <= world_->size(); ++ranks) groups_.push_back(world_->first(ranks));
    if (world_->size() > 1) link_ = measure_link(*world_);
  }

  Result<void> run() {
    auto workloads = options_.kernels;
    if (workloads.empty()) workloads = ScalingSetting::workloads();
    const std::size_t series = 2 + std::size(kBalances) * (groups_.size() - 1);
    if (speaks())
      progress_.emplace(
          "scaling", static_cast<std::int64_t>(workloads.size() * options_.gazes.size() *
                                               static_cast<std::size_t>(options_.rounds) * series));
    for (const std::string& workload : workloads) {
      workload_ = workload;
      scene_ = options_.scene.empty() ? ScalingSetting::standard_scene(workload) : options_.scene;
      auto setting =
          ScalingSetting::create(workload, scene_, options_.width_px, options_.height_px);
      if (!setting) return base::forward(setting);
      for (const std::string& gaze : options_.gazes) {
        if (const auto done = look(**setting, gaze); !done) return done;
      }
    }
    return {};
  }
  bool speaks() const { return !world_ || world_->rank() == 0; }
  const std::vector<Fields>& rows() const { return rows_; }
  const std::optional<Link>& link() const { return link_; }

 private:
  static constexpr Balance kBalances[] = {Balance::Predicted, Balance::Stripes, Balance::Dynamic};
  using Key = std::pair<int, Balance>;

  Result<void> look(const ScalingSetting& setting, const std::string& text) {
    const auto gaze = parse_gaze("--gazes", text);
    if (!gaze) return base::forward(gaze);
    gaze_ = text;
    measured_.clear(), traces_.clear(), plain_ms_.clear();
    for (int round = 0; round < options_.rounds; ++round) {
      if (speaks() && !measure_plain(setting, *gaze)) return stopped();
      for (std::size_t i = 0; i < groups_.size(); ++i) {
        for (const Balance balance : kBalances) {
          const int ranks = static_cast<int>(i) + 1;
          if (ranks == 1 && balance != Balance::Predicted) continue;
          if (!together(setting, *gaze, groups_[i], ranks, balance)) return stopped();
        }
      }
    }
    if (speaks()) tell();
    return {};
  }
  static Result<void> stopped() {
    return base::runtime_error("a frame was not finished", "scaling");
  }

  /// As a server that was started alone: nothing is recorded, nothing shared.
  bool measure_plain(const ScalingSetting& setting, const StillGaze& gaze) {
    class Timed final : public kernels::Kernel {
     public:
      Timed(const kernels::Kernel& kernel, std::vector<double>& all) : kernel_(kernel), all_(all) {}
      kernels::FrameReport render(const kernels::FrameRequest& request,
                                  const kernels::SceneFrame& scene, kernels::History& history,
                                  kernels::TileScheduler& scheduler,
                                  kernels::FrameBuffers& out) const override {
        const auto begin = std::chrono::steady_clock::now();
        auto report = kernel_.render(request, scene, history, scheduler, out);
        const std::chrono::duration<double, std::milli> took =
            std::chrono::steady_clock::now() - begin;
        all_.push_back(took.count());
        return report;
      }
      void shade(std::span<const kernels::SurfacePoint>, const kernels::SceneFrame&,
                 kernels::TileScheduler&, std::span<Rgb>) const override {}

     private:
      const kernels::Kernel& kernel_;
      std::vector<double>& all_;
    };
    std::vector<double> all;
    const Timed timed(*setting.kernels().front(), all);
    if (!setting.render(timed, gaze, options_.warm_up + options_.frames, scheduler_)) return false;
    plain_ms_.insert(plain_ms_.end(), all.begin() + options_.warm_up, all.end());
    progress_->advance();
    return true;
  }

  /// A series by the first `ranks` ranks; the others wait for the next.
  bool together(const ScalingSetting& setting, const StillGaze& gaze, const Group& group, int ranks,
                Balance balance) {
    scheduling::Bytes turn(1);
    if (world_ && !world_->broadcast(turn)) return false;
    if (!group) return true;
    if (!speaks()) {
      const auto done =
          cluster::follow(*group, {setting.kernels(), setting.timeline(), scheduler_, balance});
      return done.has_value();
    }
    const auto leader = std::make_shared<cluster::Leader>(group, balance);
    int frame = 0;
    leader->watch([&](const SharedFrame& shared) {
      if (frame++ < options_.warm_up) return;
      measured_[{ranks, balance}].add(shared, ranks);
      if (ranks == 1) add_trace(shared);
    });
    const cluster::RankedKernel kernel(setting.kernels().front(), 0, leader);
    const bool good = setting.render(kernel, gaze, options_.warm_up + options_.frames, scheduler_);
    leader->end();
    progress_->advance();
    return good;
  }

  void add_trace(const SharedFrame& frame) {
    const double threaded = threaded_ms(frame);
    traces_.push_back({frame.passes, alone_ms(frame) - threaded, threaded});
  }
  Fields row(int ranks, int threads, Balance balance) const {
    return {{"kernel", workload_},
            {"scene", scene_},
            {"gaze", gaze_},
            {"ranks", std::int64_t{ranks}},
            {"threads_per_rank", std::int64_t{threads}},
            {"balance", std::string(scheduling::kBalanceNames[static_cast<int>(balance)])}};
  }
  void tell() {
    const double one_ms = median(plain_ms_);
    for (const auto& [key, of] : measured_) {
      const auto& [ranks, balance] = key;
      const double frame_ms = ranks == 1 ? one_ms : median(of.frame_ms);
      const double one_path_ms = median(measured_.at({1, Balance::Predicted}).path_ms);
      Fields fields = row(ranks, options_.threads, balance);
      append(fields, frame_ms, one_ms / (ranks * frame_ms), median(of.comm_bytes),
             median(of.imbalance), false);
      fields.emplace_back("path_ms", median(of.path_ms));
      fields.emplace_back("path_efficiency", one_path_ms / (ranks * median(of.path_ms)));
      for (const char* part : kParts) fields.emplace_back(part, kNothing);
      rows_.push_back(std::move(fields));
    }
    for (const auto& [key, of] : measured_)
      if (key.first > 1 && link_) check(key.first, key.second, of);
    for (const int threads : options_.model_threads)
      for (const Balance balance : kBalances)
        for (const int ranks : options_.ranks) model(ranks, threads, balance);
  }
  static constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
  static constexpr const char* kParts[] = {"tiles_ms", "alone_ms", "copy_ms", "transfer_ms",
                                           "off_measured"};
  static void append(Fields& fields, double frame_ms, double efficiency, double bytes,
                     double imbalance, bool simulated) {
    fields.emplace_back("frame_ms", frame_ms);
    fields.emplace_back("efficiency", efficiency);
    fields.emplace_back("comm_bytes", bytes);
    fields.emplace_back("imbalance", imbalance);
    fields.emplace_back("simulated", simulated);
  }

  /// Medians over the traces.
  ModelledFrame modelled(const ClusterSpec& spec, Balance balance) const {
    std::vector<ModelledFrame> frames;
    for (const FrameTrace& trace : traces_) frames.push_back(model_frame(trace, spec, balance));
    std::ranges::sort(frames, {}, &ModelledFrame::frame_ms);
    return frames[frames.size() / 2];
  }
  ClusterSpec spec_of(int ranks, int threads) const {
    ClusterSpec spec{.ranks = ranks, .threads = threads};
    spec.latency_ms = 1e-3 * options_.latency_us, spec.bytes_per_ms = options_.gbit_s * 1e6 / 8.0;
    spec.copied_bytes_per_ms = options_.copy_gb_s * 1e6;
    return spec;
  }
  void model(int ranks, int threads, Balance balance) {
    const ModelledFrame one = modelled(spec_of(1, threads), balance);
    add_modelled(modelled(spec_of(ranks, threads), balance), one.frame_ms, ranks, threads, balance,
                 kNothing);
  }
  /// The machine that measured, modelled: its link, its copies.
  void check(int ranks, Balance balance, const Measured& of) {
    ClusterSpec spec = spec_of(ranks, options_.threads);
    spec.latency_ms = link_->latency_ms, spec.bytes_per_ms = link_->bytes_per_ms;
    spec.message_ms = 0.0;  // in the latency
    spec.copied_bytes_per_ms = of.packed_bytes / of.pack_ms;
    const ModelledFrame one = modelled(spec_of(1, options_.threads), balance);
    const ModelledFrame frame = modelled(spec, balance);
    add_modelled(frame, one.frame_ms, ranks, options_.threads, balance,
                 frame.frame_ms / median(of.frame_ms) - 1.0);
  }
  void add_modelled(const ModelledFrame& frame, double one_ms, int ranks, int threads,
                    Balance balance, double off) {
    Fields fields = row(ranks, threads, balance);
    append(fields, frame.frame_ms, one_ms / (ranks * frame.frame_ms), frame.comm_bytes,
           frame.imbalance, true);
    fields.emplace_back("path_ms", kNothing);
    fields.emplace_back("path_efficiency", kNothing);
    const double parts[] = {frame.tiles_ms, frame.alone_ms, frame.copy_ms, frame.transfer_ms, off};
    for (std::size_t i = 0; i < std::size(parts); ++i) fields.emplace_back(kParts[i], parts[i]);
    rows_.push_back(std::move(fields));
  }

  const ScalingOptions& options_;
  std::shared_ptr<cluster::MpiRanks> world_;
  scheduling::TileScheduler scheduler_;
  std::vector<Group> groups_;  ///< of the first 1, 2, ... ranks; null: this one is not among them
  std::optional<Link> link_;
  std::string workload_, scene_, gaze_;
  std::map<Key, Measured> measured_;
  std::vector<double> plain_ms_;
  std::vector<FrameTrace> traces_;
  std::vector<Fields> rows_;
  std::optional<Progress> progress_;
};

Fields config_of(const ScalingOptions& options, const std::optional<Link>& link) {
  Fields config{{"width_px", std::int64_t{options.width_px}},
                {"height_px", std::int64_t{options.height_px}},
                {"eyes", std::int64_t{2}},
                {"warm_up", std::int64_t{options.warm_up}},
                {"frames", std::int64_t{options.frames}},
                {"rounds", std::int64_t{options.rounds}},
                {"latency_us", options.latency_us},
                {"link_gbit_s", options.gbit_s},
                {"copy_gb_s", options.copy_gb_s}};
  if (link) {
    config.emplace_back("measured_latency_us", 1e3 * link->latency_ms);
    config.emplace_back("measured_link_gbit_s", 8e-6 * link->bytes_per_ms);
  }
  return config;
}

}  // namespace

void make_quick(ScalingOptions& options) {
  options.width_px = 320, options.height_px = 356;
  options.frames = 2, options.rounds = 1, options.gazes = {"0,0"};
  options.ranks = {1, 2, 32};
}

Result<void> run_scaling(const ScalingOptions& options) {
  std::shared_ptr<cluster::MpiRanks> world;
  if (options.launched_by_mpi) {
    auto made = cluster::MpiRanks::create(std::chrono::minutes{10});
    if (!made) return base::forward(made);
    world = std::move(*made);
  }
  Experiment experiment(options, world);
  const auto done = experiment.run();
  if (!done || !experiment.speaks()) return done;
  const Report report{"scaling", config_of(options, experiment.link()), experiment.rows()};
  std::fputs(table_text(report.rows).c_str(), stdout);
  return options.json.empty() ? Result<void>{} : write_json(options.json, report);
}

}  // namespace macula::bench
