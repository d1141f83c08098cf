#include "server/lights/cut_sampler.h"

#include <algorithm>

#include "shared/base/check.h"

namespace macula::lights {
namespace {

/// Distinct from the dimensions that place primary samples and from those of the other terms.
constexpr std::uint32_t kLeafDimension = 0xC000'0000U;

std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
  x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
  x = ((x >> 4) & 0x0F0F0F0FU) | ((x & 0x0F0F0F0FU) << 4);
  return __builtin_bswap32(x);
}

}  // namespace

/// 53 bits, since a walk through a million lights uses up twenty: van der Corput's sequence, its
/// digits flipped at random.
double leaf_number(sampling::SampleKey key, std::uint32_t round, std::uint32_t sample) {
  const std::uint64_t flips = math::hash_combine(key.value, kLeafDimension + round);
  const std::uint64_t bits = (std::uint64_t{reverse_bits(sample)} << 32) ^ flips;
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

void CutSampler::cut(const sampling::Vec3Batch& points, const sampling::Vec3Batch& normals,
                     std::size_t count, std::span<const std::uint16_t> most) {
  MACULA_DCHECK(count <= sampling::kBatch && (most.empty() || most.size() >= count));
  count_ = count;
  rounds_ = 0;
  nodes_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    first_[i] = static_cast<std::uint32_t>(nodes_.size());
    receivers_[i] = {points[i], normals[i]};
    const std::size_t nodes = most.empty() ? most_nodes_ : most[i];
    MACULA_DCHECK(nodes >= 1 && nodes <= most_nodes_);
    LightWalk(tree_, receivers_[i], rule_).cut(nodes, cut_);
    nodes_.insert(nodes_.end(), cut_.nodes.begin(), cut_.nodes.end());
    rounds_ = std::max(rounds_, cut_.nodes.size());
  }
  first_[count] = static_cast<std::uint32_t>(nodes_.size());
}

void CutSampler::draw(std::size_t round, std::span<const sampling::SampleKey> keys,
                      std::uint32_t sample, LightDraws& out) const {
  MACULA_DCHECK(keys.size() >= count_);
  std::array<Descent, sampling::kBatch> descents;
  std::array<std::size_t, sampling::kBatch> receiver_of;
  std::size_t walks = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    out.light.at[i] = 0;
    out.inverse_probability.at[i] = 0.0F;
    const std::size_t node = first_[i] + round;
    if (node >= first_[i + 1]) continue;
    descents[walks] = {receivers_[i], nodes_[node],
                       leaf_number(keys[i], static_cast<std::uint32_t>(round), sample)};
    receiver_of[walks++] = i;
  }
  std::array<LeafChoice, sampling::kBatch> choices;
  choose_each(tree_, rule_, {descents.data(), walks}, choices);
  for (std::size_t k = 0; k < walks; ++k) {
    if (choices[k].leaf == 0) continue;
    out.light.at[receiver_of[k]] = *tree_.light_at(choices[k].leaf);
    out.inverse_probability.at[receiver_of[k]] = static_cast<float>(1.0 / choices[k].probability);
  }
}

}  // namespace macula::lights
