#include "server/kernels/lightcuts/low_samples.h"

#include <algorithm>
#include <bit>

#include "shared/base/check.h"

namespace macula::kernels::lightcuts {
namespace {

using lights::LeafChoice;
using lights::NodeId;

constexpr LeafChoice kWalk{0, 0.0}, kNothing{0, 1.0};

/// Nodes of different levels in the order of their leaves: all moved down to one level.
constexpr NodeId first_below(NodeId node) {
  return node << std::countl_zero(node);
}
constexpr NodeId last_below(NodeId node) {
  return first_below(node) + ((NodeId{1} << std::countl_zero(node)) - 1U);
}
bool holds(NodeId node, NodeId inner) {
  const int down = lights::level_of(inner) - lights::level_of(node);
  return down >= 0 && inner >> down == node;
}

}  // namespace

LowSamples::LowSamples(const lights::Receiver& receiver, std::vector<LowSample> samples)
    : receiver_(receiver), samples_(std::move(samples)) {
  std::ranges::sort(samples_, {}, [](const LowSample& s) { return first_below(s.node); });
  double open = 0.0;
  for (const LowSample& sample : samples_) open += static_cast<double>(sample.open);
  // What was hidden there may be in sight here; what is dark there may shine here.
  constexpr double kHidden = 0.1, kUnseen = 0.05;
  const auto n = static_cast<double>(samples_.size());
  const double least = open > 0.0 ? kUnseen * open / n : 1.0;
  double sum = 0.0;
  shares_.push_back(0.0);
  for (const LowSample& sample : samples_) {
    first_.push_back(first_below(sample.node));
    sum += static_cast<double>(sample.brought) + kHidden * static_cast<double>(sample.open) + least;
    shares_.push_back(sum);
  }
}

LeafChoice LowSamples::take(const lights::LightTree& tree, NodeId node, double u) const {
  const auto at = [&](NodeId place) {
    return static_cast<std::size_t>(std::ranges::lower_bound(first_, place) - first_.begin());
  };
  const std::size_t first = at(first_below(node));
  const NodeId last_leaf = last_below(node);
  if (first < samples_.size() && first_[first] <= last_leaf) {
    if (!holds(node, samples_[first].node)) return take_below(tree, samples_[first], node);
    std::size_t last = first + 1;
    while (last < samples_.size() && first_[last] <= last_leaf) ++last;
    return take_of_many(first, last, u);
  }
  if (first > 0 && holds(samples_[first - 1].node, node)) {
    return take_below(tree, samples_[first - 1], node);
  }
  return kWalk;
}

LeafChoice LowSamples::take_of_many(std::size_t first, std::size_t last, double u) const {
  const double begin = shares_[first], all = shares_[last] - begin;
  const auto end = shares_.begin() + static_cast<std::ptrdiff_t>(last);
  const auto above = std::upper_bound(shares_.begin() + static_cast<std::ptrdiff_t>(first) + 1, end,
                                      begin + u * all);
  const auto i = static_cast<std::size_t>(above - shares_.begin()) - 1;
  const LowSample& sample = samples_[i];
  if (sample.leaf == 0) return kNothing;
  return {sample.leaf, sample.probability * ((shares_[i + 1] - shares_[i]) / all)};
}

LeafChoice LowSamples::take_below(const lights::LightTree& tree, const LowSample& sample,
                                  NodeId node) const {
  if (sample.leaf == 0 || !holds(node, sample.leaf)) return kWalk;
  const lights::LightWalk walk(tree, receiver_, lights::WeightRule::Defensive);
  return {sample.leaf, sample.probability / walk.probability(sample.node, node)};
}

}  // namespace macula::kernels::lightcuts
