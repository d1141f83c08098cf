#include "server/kernels/ray/sampling_mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <tuple>
#include <utility>

#include "server/sampling/blue_noise.h"
#include "server/sampling/sample.h"

namespace macula::kernels::ray {
namespace {

constexpr int kTableSize = 4096;

float independent_threshold(int x, int y, std::uint64_t frame, std::uint64_t seed) {
  constexpr std::uint32_t kDimension = 0xC0FFU;
  const auto cell = static_cast<std::uint64_t>(y) << 32U | static_cast<std::uint32_t>(x);
  return sampling::sample(seed, frame, cell, kDimension);
}

/// body(rectangle) for squares of `side` that cover an area, row by row.
template <class Body>
void for_each_block(const image::Rect& area, int side, const Body& body) {
  for (int y = area.y; y < area.y + area.height; y += side) {
    for (int x = area.x; x < area.x + area.width; x += side) {
      body(image::Rect{x, y, std::min(side, area.x + area.width - x),
                       std::min(side, area.y + area.height - y)});
    }
  }
}

/// First cell of every quad along an axis, and the end.
std::vector<int> quad_starts(const SupportAxis& axis) {
  std::vector<int> starts;
  for (int cell = 0; cell < static_cast<int>(axis.left.size()); ++cell) {
    if (cell == 0 || axis.left[cell] != axis.left[cell - 1]) starts.push_back(cell);
  }
  starts.push_back(static_cast<int>(axis.left.size()));
  return starts;
}

constexpr int kOuter = 64, kMiddle = 16, kInner = 4;  ///< cells

/// body(x, y) for the cells of a block, block by block within larger blocks, so that a packet's and
/// a batch's cells are neighbours however sparse.
template <class Body>
void for_each_cell_nested(const image::Rect& outer, const Body& body) {
  for_each_block(outer, kMiddle, [&](const image::Rect& middle) {
    for_each_block(middle, kInner, [&](const image::Rect& inner) {
      for (int y = inner.y; y < inner.y + inner.height; ++y) {
        for (int x = inner.x; x < inner.x + inner.width; ++x) body(x, y);
      }
    });
  });
}

void append(const std::vector<std::vector<image::Pixel>>& parts, std::vector<image::Pixel>& list) {
  std::size_t total = list.size();
  for (const auto& part : parts) total += part.size();
  list.reserve(total);
  for (const auto& part : parts) list.insert(list.end(), part.begin(), part.end());
}

constexpr int kBandRows = kOuter;
std::size_t band_count(int height) {
  return static_cast<std::size_t>(height + kBandRows - 1) / kBandRows;
}
image::Rect band_of(std::size_t band, int width, int height) {
  const int top = static_cast<int>(band) * kBandRows;
  return {0, top, width, std::min(kBandRows, height - top)};
}

}  // namespace

Probability::Probability(const FoveationMap::ViewInput& view, const foveation::RateModel& model,
                         float density)
    : view_(view),
      gaze_(glm::normalize(view.gaze.direction)),
      per_area_(
          static_cast<float>(1.0 / (view.nominal_pixel_tangent.x * view.nominal_pixel_tangent.y))) {
  for (int i = 0; i <= kTableSize; ++i) {
    const double half_sine = static_cast<double>(i) / kTableSize;
    const auto rate = static_cast<float>(model.rate(Radians{2.0 * std::asin(half_sine)}));
    rates_.push_back(rate < 1.0F ? density * rate : rate);
  }
  for (int x = 0; x < view.grid.width(); ++x) {
    tangent_x_.push_back(view.grid.tangent(x, 0).x);
    cell_width_.push_back(view.grid.footprint(x, 0).x);
  }
}

ProbabilityRow Probability::arguments(int y, int first, int count) const {
  const auto begin = static_cast<std::size_t>(first), length = static_cast<std::size_t>(count);
  return {gaze_,
          view_.grid.tangent(0, y).y,
          std::span(tangent_x_).subspan(begin, length),
          std::span(cell_width_).subspan(begin, length),
          view_.grid.footprint(0, y).y * per_area_,
          rates_};
}

float Probability::at(int x, int y) const {
  float p = 0.0F;
  probabilities(arguments(y, x, 1), {&p, 1});
  return p;
}

void Probability::row(int y, std::span<float> out) const {
  probabilities(arguments(y, 0, static_cast<int>(out.size())), out);
}

float next_density(float density, float traced, float budget) {
  constexpr float kLeast = 1.0F / 64.0F;  // below it hardly anything is left to chance
  const float ratio = budget / traced;
  return std::clamp(density * ratio * ratio, kLeast, 1.0F);
}

SamplingMask::SamplingMask(const Support& support, int width, int height)
    : support_(support),
      quad_columns_(quad_starts(support.x)),
      quad_rows_(quad_starts(support.y)),
      reasons_(width, height, Reason::None) {}

void SamplingMask::choose(const Probability& probability, std::uint64_t frame, std::uint64_t seed,
                          const FoveatedConfig& config, TileScheduler& scheduler) {
  const int width = reasons_.width(), height = reasons_.height();
  std::vector<std::size_t> chance(band_count(height), 0);
  scheduler.run(chance.size(), [&](std::size_t band) {
    const image::Rect strip = band_of(band, width, height);
    for (int y = strip.y; y < strip.y + strip.height; ++y) {
      chance[band] += choose_row(probability, y, frame, seed, config.mask);
    }
  });
  for (const std::size_t count : chance) counts_.chance += count;
  list([](Reason reason) { return reason != Reason::None; }, chosen_, scheduler);
}

std::size_t SamplingMask::choose_row(const Probability& probability, int y, std::uint64_t frame,
                                     std::uint64_t seed, MaskKind kind) {
  const std::span<Reason> row = reasons_.row(y);
  std::vector<float> p(row.size());
  probability.row(y, p);
  std::size_t count = 0;
  if (kind == MaskKind::BlueNoise) {
    static_assert(sizeof(Reason) == 1 && static_cast<int>(Reason::Chance) == 1 &&
                  static_cast<int>(Reason::Fovea) == 2);
    count =
        compare_thresholds(p, sampling::BlueNoise::get().row(y), sampling::BlueNoise::moved(frame),
                           {reinterpret_cast<std::uint8_t*>(row.data()), row.size()});
  } else {
    for (int x = 0; x < reasons_.width(); ++x) {
      const bool by_chance = independent_threshold(x, y, frame, seed) < p[x];
      row[x] = p[x] >= 1.0F ? Reason::Fovea : by_chance ? Reason::Chance : Reason::None;
      count += row[x] != Reason::None;
    }
  }
  if (support_.y.chosen[y] == 0) return count;
  for (const int x : support_.x.cells) {
    if (row[x] != Reason::Fovea) row[x] = Reason::Support;
  }
  return count;
}

template <class Wanted>
void SamplingMask::list(const Wanted& wanted, std::vector<image::Pixel>& cells,
                        TileScheduler& scheduler) const {
  const int width = reasons_.width(), height = reasons_.height();
  std::vector<std::vector<image::Pixel>> bands(band_count(height));
  scheduler.run(bands.size(), [&](std::size_t band) {
    bands[band].reserve(static_cast<std::size_t>(width) * kBandRows / 4);  // about what is traced
    for_each_block(band_of(band, width, height), kOuter, [&](const image::Rect& outer) {
      // Written without a branch: which cells are traced is chance.
      std::array<image::Pixel, kOuter * kOuter + 1> found;
      std::size_t count = 0;
      for_each_cell_nested(outer, [&](int x, int y) {
        found[count] = {x, y};
        count += wanted(reasons_(x, y)) ? 1 : 0;
      });
      bands[band].insert(bands[band].end(), found.begin(), found.begin() + count);
    });
  });
  append(bands, cells);
}

/// Forgotten cells first, then quads by score.
void SamplingMask::resample(std::vector<image::Pixel> forgotten, const Cache& remembered,
                            const Plane<float>& scores, std::uint64_t frame,
                            const FoveatedConfig& config, TileScheduler& scheduler) {
  unknown_ = std::move(forgotten);
  counts_.forgotten = unknown_.size();
  const auto most = static_cast<double>(most_resampled(config));
  resample_forgotten(most, frame);
  const double left = most - static_cast<double>(counts_.forgotten);
  if (left > 0.0) resample_quads(scores, left, remembered, frame);
  list([](Reason reason) { return reason == Reason::Resampled; }, resampled_, scheduler);
  counts_.resampled = resampled_.size();
}

std::size_t SamplingMask::most_resampled(const FoveatedConfig& config) const {
  const double share = std::clamp(static_cast<double>(config.most_resampled), 0.0, 1.0);
  if (share >= 1.0) return reasons_.size();
  return static_cast<std::size_t>(share / (1.0 - share) * static_cast<double>(chosen_.size()));
}

void SamplingMask::resample_forgotten(double most, std::uint64_t frame) {
  const auto forgotten = static_cast<double>(unknown_.size());
  const float below = forgotten > most ? static_cast<float>(most / forgotten) : 1.0F;
  std::vector<image::Pixel> unknown;
  double resampled = 0.0;
  for (const image::Pixel& cell : unknown_) {
    const bool taken = sampling::BlueNoise::get().threshold(cell.x, cell.y, frame) < below;
    if (taken && resampled < most) {
      reasons_(cell.x, cell.y) = Reason::Resampled;
      ++resampled;
    } else {
      unknown.push_back(cell);
    }
  }
  unknown_ = std::move(unknown);
}

/// Equal scores in an order that changes every frame.
void SamplingMask::resample_quads(const Plane<float>& scores, double most, const Cache& remembered,
                                  std::uint64_t frame) {
  struct Quad {
    float score;
    std::uint64_t order;
    int x, y;
    bool operator<(const Quad& other) const {
      return std::tie(other.score, order) < std::tie(score, other.order);
    }
  };
  std::vector<Quad> ranked;
  for (int y = 0; y < scores.height(); ++y) {
    for (int x = 0; x < scores.width(); ++x) {
      if (scores(x, y) <= 0.0F) continue;
      const auto index = static_cast<std::uint64_t>(y) * scores.width() + x;
      ranked.push_back({scores(x, y), math::hash_combine(frame, index), x, y});
    }
  }
  std::ranges::sort(ranked, std::less<>());
  for (const Quad& quad : ranked) {
    const std::vector<image::Pixel> open = open_cells(quad.x, quad.y, remembered);
    most -= static_cast<double>(open.size());
    if (most < 0.0) return;
    for (const image::Pixel& cell : open) reasons_(cell.x, cell.y) = Reason::Resampled;
  }
}

/// Cells of a quad that are remembered and not traced.
std::vector<image::Pixel> SamplingMask::open_cells(int quad_x, int quad_y,
                                                   const Cache& remembered) const {
  std::vector<image::Pixel> open;
  for (int y = quad_rows_[quad_y]; y < quad_rows_[quad_y + 1]; ++y) {
    for (int x = quad_columns_[quad_x]; x < quad_columns_[quad_x + 1]; ++x) {
      const bool known = remembered.remembers(x, y);
      if (known && reasons_(x, y) == Reason::None) open.push_back({x, y});
    }
  }
  return open;
}

}  // namespace macula::kernels::ray
