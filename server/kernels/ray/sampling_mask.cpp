#include "server/kernels/ray/sampling_mask.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include "server/sampling/blue_noise.h"
#include "server/sampling/sample.h"

namespace macula::kernels::ray {
namespace {

constexpr int kTableSize = 4096;

float threshold(int x, int y, std::uint64_t frame, std::uint64_t seed, MaskKind kind) {
  if (kind == MaskKind::BlueNoise) return sampling::BlueNoise::get().threshold(x, y, frame);
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

}  // namespace

Probability::Probability(const FoveationMap::ViewInput& view, const foveation::RateModel& model)
    : view_(view),
      gaze_(glm::normalize(view.gaze.direction)),
      per_area_(
          static_cast<float>(1.0 / (view.nominal_pixel_tangent.x * view.nominal_pixel_tangent.y))) {
  for (int i = 0; i <= kTableSize; ++i) {
    const double half_sine = static_cast<double>(i) / kTableSize;
    rates_.push_back(static_cast<float>(model.rate(Radians{2.0 * std::asin(half_sine)})));
  }
}

float Probability::at(int x, int y) const {
  const Vec3 ray = view_.grid.ray(x, y);
  const float cosine = glm::dot(gaze_, ray) / glm::length(ray);
  const float half_sine = std::sqrt(std::clamp(0.5F - 0.5F * cosine, 0.0F, 1.0F));
  const float rate = rates_[static_cast<std::size_t>(half_sine * kTableSize)];
  const Vec2 cell = view_.grid.footprint(x, y);
  // A cell of nominal size is 1 to rounding: as full as it can be.
  const float area = std::max(cell.x * cell.y * per_area_, 0.0F);
  return std::min(rate * (std::abs(area - 1.0F) < 1e-3F ? 1.0F : area), 1.0F);
}

void Probability::row(int y, std::span<float> out) const {
  for (int x = 0; x < static_cast<int>(out.size()); ++x) out[x] = at(x, y);
}

SamplingMask::SamplingMask(const Support& support, int width, int height)
    : support_(support),
      reasons_(width, height, Reason::None),
      forgotten_(width, height, 0),
      open_(support.broken.width(), support.broken.height(), 0) {}

void SamplingMask::mark_support() {
  for (const int y : support_.y.cells) {
    for (const int x : support_.x.cells) reasons_(x, y) = Reason::Support;
  }
}

void SamplingMask::draw(const Probability& probability, const Cache* remembered,
                        std::uint64_t frame, std::uint64_t seed, const FoveatedConfig& config,
                        TileScheduler& scheduler) {
  const std::vector<int> starts = quad_starts(support_.y);
  std::vector<MaskCounts> parts(starts.size() - 1);
  scheduler.run(parts.size(), [&](std::size_t band) {
    std::vector<float> p(reasons_.width());
    MaskCounts& counts = parts[band];
    for (int y = starts[band]; y < starts[band + 1]; ++y) {
      probability.row(y, p);
      for (int x = 0; x < reasons_.width(); ++x) {
        Reason& reason = reasons_(x, y);
        if (p[x] >= 1.0F) {
          reason = reason == Reason::None ? Reason::Fovea : reason;
        } else if (reason == Reason::None && threshold(x, y, frame, seed, config.mask) < p[x]) {
          reason = Reason::Chance;
        }
        counts.chance += reason == Reason::Fovea || reason == Reason::Chance;
        const bool forgotten = remembered == nullptr || !remembered->remembers(x, y);
        if (reason != Reason::None) continue;
        forgotten_(x, y) = forgotten;
        counts.forgotten += forgotten;
        if (!forgotten) ++open_(support_.x.left[x], support_.y.left[y]);
      }
    }
  });
  for (const MaskCounts& part : parts) {
    counts_.chance += part.chance;
    counts_.forgotten += part.forgotten;
  }
}

/// Forgotten cells first, then quads by score; equal scores in an order that changes every frame.
SamplingMask::Cutoff SamplingMask::cutoff(const Plane<float>& scores, std::uint64_t frame,
                                          const FoveatedConfig& config) const {
  const std::size_t support = support_.x.cells.size() * support_.y.cells.size();
  const auto chosen = static_cast<double>(counts_.chance + support);
  const double share = std::clamp(static_cast<double>(config.most_resampled), 0.0, 1.0);
  const double most =
      share < 1.0 ? share / (1.0 - share) * chosen : static_cast<double>(reasons_.size());
  const auto forgotten = static_cast<double>(counts_.forgotten);
  Cutoff cut{1.0F, Plane<std::uint8_t>(scores.width(), scores.height(), 0)};
  if (forgotten > most) {
    cut.forgotten = static_cast<float>(most / forgotten);
    return cut;
  }
  struct Quad {
    float score;
    std::uint64_t order;
    std::size_t index;
    bool operator<(const Quad& other) const {
      return std::tie(other.score, order) < std::tie(score, other.order);
    }
  };
  std::vector<Quad> ranked;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (scores.pixels()[i] > 0.0F && open_.pixels()[i] > 0) {
      ranked.push_back({scores.pixels()[i], math::hash_combine(frame, i), i});
    }
  }
  std::ranges::sort(ranked, std::less<>());
  double left = most - forgotten;
  for (const Quad& quad : ranked) {
    left -= open_.pixels()[quad.index];
    if (left < 0.0) break;
    cut.quads.pixels()[quad.index] = 1;
  }
  return cut;
}

void SamplingMask::resample(const Plane<float>& scores, std::uint64_t frame,
                            const FoveatedConfig& config, TileScheduler& scheduler) {
  const Cutoff cut = cutoff(scores, frame, config);
  const std::vector<int> starts = quad_starts(support_.y);
  std::vector<std::size_t> parts(starts.size() - 1);
  scheduler.run(parts.size(), [&](std::size_t band) {
    for (int y = starts[band]; y < starts[band + 1]; ++y) {
      for (int x = 0; x < reasons_.width(); ++x) {
        if (reasons_(x, y) != Reason::None) continue;
        const bool wanted = forgotten_(x, y) != 0
                                ? threshold(x, y, frame, 0, MaskKind::BlueNoise) < cut.forgotten
                                : cut.quads(support_.x.left[x], support_.y.left[y]) != 0;
        if (!wanted) continue;
        reasons_(x, y) = Reason::Resampled;
        ++parts[band];
      }
    }
  });
  for (const std::size_t part : parts) counts_.resampled += part;
}

std::vector<image::Pixel> SamplingMask::support_cells() const {
  std::vector<image::Pixel> list;
  list.reserve(support_.x.cells.size() * support_.y.cells.size());
  for_each_block({0, 0, support_.x.count(), support_.y.count()}, 4, [&](const image::Rect& block) {
    for (int j = block.y; j < block.y + block.height; ++j) {
      for (int i = block.x; i < block.x + block.width; ++i) {
        list.push_back({support_.x.cells[i], support_.y.cells[j]});
      }
    }
  });
  return list;
}

/// Blocks within blocks, so that a packet's and a batch's cells are neighbours however sparse.
std::vector<image::Pixel> SamplingMask::other_cells(TileScheduler& scheduler) const {
  constexpr int kOuter = 64, kMiddle = 16, kInner = 4;
  const int width = reasons_.width(), height = reasons_.height();
  std::vector<std::vector<image::Pixel>> bands(static_cast<std::size_t>(height + kOuter - 1) /
                                               kOuter);
  scheduler.run(bands.size(), [&](std::size_t band) {
    const int top = static_cast<int>(band) * kOuter;
    const image::Rect strip{0, top, width, std::min(kOuter, height - top)};
    for_each_block(strip, kOuter, [&](const image::Rect& outer) {
      for_each_block(outer, kMiddle, [&](const image::Rect& middle) {
        for_each_block(middle, kInner, [&](const image::Rect& inner) {
          for (int y = inner.y; y < inner.y + inner.height; ++y) {
            for (int x = inner.x; x < inner.x + inner.width; ++x) {
              const Reason reason = reasons_(x, y);
              if (reason != Reason::None && reason != Reason::Support)
                bands[band].push_back({x, y});
            }
          }
        });
      });
    });
  });
  std::vector<image::Pixel> list;
  list.reserve(counts_.chance + counts_.resampled);
  for (const auto& band : bands) list.insert(list.end(), band.begin(), band.end());
  return list;
}

}  // namespace macula::kernels::ray
