#include "client/app/comparison.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>

#include "shared/base/cpu_time.h"
#include "shared/metrics/error.h"
#include "shared/metrics/flip.h"

namespace macula::client_app {
namespace {

using reprojection::WarpOptions;
using Way = Comparison::Way;

const std::array<Way, 7> kWays{{
    {"mesh", {}},
    {"mesh, newest frame", {}, Way::Frame::Newest},
    {"mesh, one layer", {.layers = WarpOptions::Layers::First}},
    {"mesh, stretched", {.silhouettes = WarpOptions::Silhouettes::Stretch}},
    {"grid of slow machines", warp_options(ClientConfig::Warp::Grid)},
    {"rotation", warp_options(ClientConfig::Warp::Rotation)},
    {"as it came", warp_options(ClientConfig::Warp::Stale)},
}};
constexpr int kRotation = 5;

int counted_round(int way) {
  return way % static_cast<int>(kWays.size());
}

}  // namespace

std::span<const Way> Comparison::ways() {
  return kWays;
}

int Comparison::first_of_second_side() {
  return kRotation;
}

const Pose& Comparison::hold(const Pose& stage_from_head) {
  if (!stage_from_head_) stage_from_head_ = stage_from_head;
  return *stage_from_head_;
}

void Comparison::end() {
  stage_from_head_.reset();
  held_.reset();
  sides_ = {};
  metrics_.reset();
}

void Comparison::update(const frames::FramePtr& newest, const EyeRig& rig,
                        const std::array<int, 2>& ways) {
  if (!held_) held_ = newest;
  bool changed = false;
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const int way = counted_round(ways[i]);
    if (sides_[i].way == way) continue;
    sides_[i].way = way;
    const bool is_newest = kWays[static_cast<std::size_t>(way)].frame == Way::Frame::Newest;
    warp(sides_[i], is_newest ? *newest : *held_, rig);
    changed = true;
  }
  if (changed) begin_metrics(rig);
}

/// On this thread, an eye after the other, so that its clock tells what the warp costs; twice, for
/// the first has its memory to find.
void Comparison::warp(Side& side, const frames::DecodedFrame& frame, const EyeRig& rig) {
  side.stage = std::make_unique<WarpStage>(kWays[static_cast<std::size_t>(*side.way)].options,
                                           WarpStage::Depth::Leave, WarpStage::On::Cpu,
                                           WarpStage::Eyes::OneByOne);
  side.stage->warp(frame, *stage_from_head_, rig);
  const auto begin = base::thread_cpu_time();
  side.stage->warp(frame, *stage_from_head_, rig);
  side.cpu = base::thread_cpu_time() - begin;
}

/// On copies: the sides may change meanwhile.
void Comparison::begin_metrics(const EyeRig& rig) {
  metrics_.reset();
  const auto find = [first = pictures(0), second = pictures(1),
                     ppd = rig.eyes.front().display.pixels_per_degree()] {
    Metrics sum;
    for (std::size_t eye = 0; eye < first.size(); ++eye) {
      const auto a = metrics::unit_from_8bit(first[eye]), b = metrics::unit_from_8bit(second[eye]);
      sum.psnr_db += metrics::psnr_db(a, b);
      sum.flip += metrics::summarise(metrics::flip_map(a, b, ppd)).mean;
    }
    const auto eyes = static_cast<double>(first.size());
    return Metrics{sum.psnr_db / eyes, sum.flip / eyes};
  };
  measuring_ = std::async(std::launch::async, find);
}

std::vector<std::string> Comparison::lines() {
  using namespace std::chrono_literals;
  if (measuring_.valid() && measuring_.wait_for(0s) == std::future_status::ready) {
    metrics_ = measuring_.get();
  }
  std::vector<std::string> lines;
  const auto add = [&](const char* format, auto... values) {
    std::array<char, 96> line{};
    std::snprintf(line.data(), line.size(), format, values...);
    lines.emplace_back(line.data());
  };
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const Side& side = sides_[i];
    add("%zu  %-24s %5.1f ms cpu", i + 1, kWays[static_cast<std::size_t>(*side.way)].name,
        units::to_ms(side.cpu));
  }
  if (metrics_) {
    add("psnr %.2f db   flip %.4f", metrics_->psnr_db, metrics_->flip);
  } else {
    lines.emplace_back("psnr and flip are being found");
  }
  lines.emplace_back("c next view   x swap   1 2 another way");
  return lines;
}

}  // namespace macula::client_app
