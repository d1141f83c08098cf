// Which virtual lights each point of a batch asks: every one of its class, some of them drawn by
// what they would bring, or one for every node of a cut of a light tree. All have the light of the
// whole table as their mean. Holds references; one thread at a time; large, make one a batch.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "server/kernels/ray/lighting.h"
#include "server/lights/cut_sampler.h"

namespace macula::kernels::ray {

class VirtualDraws {
 public:
  VirtualDraws(const VirtualLightShare& share, const LitPoints& points);

  /// Lights that a point asks at most.
  std::size_t rounds() const { return rounds_; }
  /// The `round`-th of every point; rows of the table.
  void draw(std::size_t round, lights::LightDraws& out) const;
  /// The points, those of one class after another: they ask the same lights.
  std::span<const std::uint16_t> by_class() const { return {by_class_.data(), points_.count}; }

 private:
  struct Choice {
    std::uint32_t row = 0;
    float inverse_probability = 0.0F;  ///< 0: no choice
  };
  int class_of(std::size_t point) const;
  void sort_by_class();
  void choose_some();
  void choose_of(std::size_t point, std::span<const float> weights);
  void cut();

  const VirtualLightShare& share_;
  const LitPoints& points_;
  std::size_t rounds_ = 0;
  std::array<std::uint16_t, sampling::kBatch> by_class_;
  std::vector<Choice> chosen_;  ///< share.asked a point; empty: every light of its class
  std::unique_ptr<lights::CutSampler> cuts_;
};

}  // namespace macula::kernels::ray
