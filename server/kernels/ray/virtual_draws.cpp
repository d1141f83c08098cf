#include "server/kernels/ray/virtual_draws.h"

#include <numeric>

namespace macula::kernels::ray {
namespace {

// Of a cell's random numbers (lighting.cpp has the others).
constexpr std::uint32_t kClassDimension = 0x8000'0004U;
constexpr std::uint32_t kChoiceDimension = 0x8000'0005U;

}  // namespace

VirtualDraws::VirtualDraws(const VirtualLightShare& share, const LitPoints& points)
    : share_(share), points_(points) {
  if (share.tree != nullptr) {
    cut();
    return;
  }
  sort_by_class();
  rounds_ = share.lights->rounds();
  if (share.asked > 0 && static_cast<std::size_t>(share.asked) < rounds_) choose_some();
}

int VirtualDraws::class_of(std::size_t point) const {
  if (!points_.light_class.empty()) return points_.light_class[point];
  const auto classes = static_cast<std::uint32_t>(share_.lights->classes());
  return static_cast<int>(
      sampling::sample_bits(points_.keys[point], kClassDimension, points_.sample) % classes);
}

/// By counting: classes are few.
void VirtualDraws::sort_by_class() {
  std::vector<std::uint16_t> first(static_cast<std::size_t>(share_.lights->classes()) + 1, 0);
  std::array<std::uint16_t, sampling::kBatch> of;
  for (std::size_t i = 0; i < points_.count; ++i) {
    of[i] = static_cast<std::uint16_t>(class_of(i));
    ++first[of[i] + 1U];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  for (std::size_t i = 0; i < points_.count; ++i)
    by_class_[first[of[i]]++] = static_cast<std::uint16_t>(i);
}

/// Systematic draws along each point's class, which is in the order of places.
void VirtualDraws::choose_some() {
  rounds_ = static_cast<std::size_t>(share_.asked);
  chosen_.assign(rounds_ * points_.count, {});
  std::vector<float> weights(share_.lights->rounds());
  for (std::size_t i = 0; i < points_.count; ++i) {
    share_.lights->weigh(class_of(i), points_.position[i], points_.reflectors.shading[i], weights);
    choose_of(i, weights);
  }
}

void VirtualDraws::choose_of(std::size_t point, std::span<const float> weights) {
  const int light_class = class_of(point);
  const float step =
      std::accumulate(weights.begin(), weights.end(), 0.0F) / static_cast<float>(rounds_);
  if (!(step > 0.0F)) return;
  Choice* choice = chosen_.data() + point * rounds_;
  const Choice* const end = choice + rounds_;
  const auto classes = static_cast<float>(share_.lights->classes());
  const std::uint32_t bits =
      sampling::sample_bits(points_.keys[point], kChoiceDimension, points_.sample);
  const float u = 0x1p-24F * static_cast<float>(bits >> 8);
  float next = u * step, passed = 0.0F;
  for (std::size_t round = 0; round < weights.size() && choice != end; ++round) {
    passed += weights[round];
    if (next >= passed) continue;
    int drawn = 0;
    for (; next < passed; next += step) ++drawn;
    *choice++ = {share_.lights->row(light_class, round),
                 classes * static_cast<float>(drawn) * step / weights[round]};
  }
}

void VirtualDraws::cut() {
  cuts_ =
      std::make_unique<lights::CutSampler>(*share_.tree, static_cast<std::size_t>(share_.asked));
  cuts_->cut(points_.position, points_.reflectors.shading, points_.count, points_.cut_nodes);
  rounds_ = cuts_->rounds();
  std::iota(by_class_.begin(), by_class_.end(), std::uint16_t{0});
}

void VirtualDraws::draw(std::size_t round, lights::LightDraws& out) const {
  if (cuts_) {
    cuts_->draw(round, points_.keys, points_.sample, out);
    for (std::size_t i = 0; i < points_.count; ++i)
      out.light.at[i] = share_.lights->row_of(out.light.at[i]);
    return;
  }
  const auto classes = static_cast<float>(share_.lights->classes());
  for (std::size_t i = 0; i < points_.count; ++i) {
    const Choice choice = chosen_.empty() ? Choice{share_.lights->row(class_of(i), round), classes}
                                          : chosen_[i * rounds_ + round];
    out.light.at[i] = choice.row;
    out.inverse_probability.at[i] = choice.inverse_probability;
  }
}

}  // namespace macula::kernels::ray
