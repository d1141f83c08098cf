// The cache update, compiled for every instruction set: colours go through vectors of four.
#include <algorithm>
#include <cmath>

#include "server/kernels/ray/blend.h"
#include "server/kernels/ray/merge.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/kernels/ray/update_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace macula::kernels::ray::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Four = hn::FixedTag<float, 4>;

using FourVec = hn::Vec<Four>;

/// What each number of a colour brings to YCoCg, and back.
HWY_ALIGN constexpr float kFromRed[4] = {0.25F, 0.5F, -0.25F, 0.0F};
HWY_ALIGN constexpr float kFromGreen[4] = {0.5F, 0.0F, 0.5F, 0.0F};
HWY_ALIGN constexpr float kFromBlue[4] = {0.25F, -0.5F, -0.25F, 0.0F};
HWY_ALIGN constexpr float kFromY[4] = {1.0F, 1.0F, 1.0F, 0.0F};
HWY_ALIGN constexpr float kFromCo[4] = {1.0F, 0.0F, -1.0F, 0.0F};
HWY_ALIGN constexpr float kFromCg[4] = {-1.0F, 1.0F, -1.0F, 0.0F};

HWY_INLINE HWY_ATTR FourVec ycocg(FourVec rgb) {
  const Four d;
  return hn::MulAdd(hn::Broadcast<0>(rgb), hn::Load(d, kFromRed),
                    hn::MulAdd(hn::Broadcast<1>(rgb), hn::Load(d, kFromGreen),
                               hn::Mul(hn::Broadcast<2>(rgb), hn::Load(d, kFromBlue))));
}
HWY_INLINE HWY_ATTR FourVec rgb(FourVec ycocg) {
  const Four d;
  return hn::MulAdd(hn::Broadcast<0>(ycocg), hn::Load(d, kFromY),
                    hn::MulAdd(hn::Broadcast<1>(ycocg), hn::Load(d, kFromCo),
                               hn::Mul(hn::Broadcast<2>(ycocg), hn::Load(d, kFromCg))));
}

/// Least and greatest inverse depth among known cells.
struct DepthRange {
  float low = INFINITY, high = 0.0F;

  void add(float inverse_depth) {
    if (inverse_depth < 0.0F) return;
    low = std::min(low, inverse_depth), high = std::max(high, inverse_depth);
  }
};

/// Of a cell and its eight neighbours.
HWY_INLINE HWY_ATTR DepthRange depths_around(const DepthRows& depths, int x) {
  const Four d;
  DepthRange range;
  if (x < 1 || x + 2 >= depths.width) {
    for (const float* row : {depths.above, depths.here, depths.below}) {
      for (int i = std::max(x - 1, 0); i <= std::min(x + 1, depths.width - 1); ++i)
        range.add(row[i]);
    }
    return range;
  }
  const auto infinite = hn::Set(d, INFINITY);
  auto low = infinite, high = hn::Zero(d);
  for (const float* at : {depths.above, depths.here, depths.below}) {
    const auto row = hn::LoadU(d, at + x - 1);
    low = hn::Min(low, hn::IfThenElse(hn::Lt(row, hn::Zero(d)), infinite, row));
    high = hn::Max(high, row);
  }
  HWY_ALIGN float lows[4], highs[4];
  hn::Store(low, d, lows), hn::Store(high, d, highs);
  return {std::min({lows[0], lows[1], lows[2]}), std::max({highs[0], highs[1], highs[2]})};
}

/// Three numbers and 0; reads one more.
HWY_INLINE HWY_ATTR FourVec three(const Rgb& c) {
  const Four d;
  return hn::IfThenElseZero(hn::FirstN(d, 3), hn::LoadU(d, &c.x));
}
HWY_INLINE HWY_ATTR FourVec load(const Texel& texel) {
  return hn::Load(Four(), &texel.r);
}
HWY_INLINE HWY_ATTR void store(FourVec v, Texel& texel) {
  hn::Store(v, Four(), &texel.r);
}
/// As the memory holds radiance: radiance_of() takes it back.
HWY_INLINE HWY_ATTR FourVec root(FourVec radiance) {
  return hn::Sqrt(hn::Max(radiance, hn::Zero(Four())));
}
HWY_INLINE HWY_ATTR FourVec squared(FourVec v) {
  return hn::Mul(v, v);
}
/// The share `t` of the way from a to b.
HWY_INLINE HWY_ATTR FourVec between(FourVec a, FourVec b, float t) {
  return hn::MulAdd(hn::Set(Four(), t), hn::Sub(b, a), a);
}

/// One traced cell's sample: radiance without the light that chance estimates, that light as it is
/// reflected, and what reflects it.
struct Fresh {
  const Rgb& radiance;
  float depth_m;
  FourVec color, sampled, reflectance;
};

/// One cell's part of the cache update.
class Update {
 public:
  Update(const MergeJob& job, Cache& cache, Plane<Rgb>& radiance)
      : job_(job), cache_(cache), radiance_(radiance) {}

  HWY_ATTR void cell(int x, int y, const DepthRows& depths) {
    CacheInfo& info = cache_.info(x, y);
    const Reason reason = job_.mask.reason(x, y);
    const std::size_t at = job_.fresh.at(x, y);
    const Fresh fresh = sample(at);
    if (depths.here[x] < 0.0F || replaces(reason) || !same_surface(x, depths, fresh.depth_m)) {
      replace(x, y, fresh, info);
    } else {
      blend(x, y, reason, fresh, info);
    }
    info.touched = job_.clock;
    show(x, y, fresh, info);
    if (!cache_.surface_id.empty()) cache_.surface_id(x, y) = job_.fresh.surface_id(at);
    if (!cache_.normal.empty()) cache_.normal(x, y) = job_.fresh.normal(at);
    if (!cache_.albedo.empty()) cache_.albedo(x, y) = job_.fresh.albedo(at);
  }

  /// Sends for what cell() reads first.
  void fetch(int x, int y) const {
    __builtin_prefetch(&cache_.color(x, y)), __builtin_prefetch(&cache_.info(x, y));
    __builtin_prefetch(&radiance_(x, y));
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, radiance_.height() - 1); ++j)
      __builtin_prefetch(&cache_.inverse_depth(x, j));
    if (!cache_.has_light()) return;
    __builtin_prefetch(&cache_.sampled(x, y)), __builtin_prefetch(&cache_.reflectance(x, y));
  }

 private:
  HWY_ATTR Fresh sample(std::size_t at) const {
    const Four d;
    const Rgb& radiance = job_.fresh.radiance(at);
    Fresh fresh{radiance, job_.fresh.depth_m(at), three(radiance), hn::Zero(d), hn::Zero(d)};
    if (!cache_.has_light()) return fresh;
    fresh.reflectance = three(job_.fresh.reflectance(at));
    fresh.sampled = hn::Mul(three(job_.fresh.light(at)), fresh.reflectance);
    fresh.color = hn::Max(hn::Sub(fresh.color, fresh.sampled), hn::Zero(d));
    return fresh;
  }

  bool replaces(Reason reason) const {
    return job_.config.fresh == FreshRule::Replace &&
           (reason == Reason::Fovea || reason == Reason::Resampled);
  }

  /// Whether the new sample lies within the depths remembered of the cell and its neighbours: what
  /// an edge pixel shows changes with the jitter. The printed test holds it against its own alone.
  HWY_ATTR bool same_surface(int x, const DepthRows& depths, float depth_m) const {
    const float fresh = 1.0F / depth_m;
    DepthRange range;
    if (job_.config.fresh == FreshRule::Replace) {
      range.add(depths.here[x]);
    } else {
      range = depths_around(depths, x);
    }
    const float slack = job_.config.merge_threshold;
    return fresh >= range.low - slack * range.low &&
           fresh <= range.high + slack * std::max(range.high, fresh);
  }

  HWY_ATTR void replace(int x, int y, const Fresh& fresh, CacheInfo& info) {
    store(root(fresh.color), cache_.color(x, y));
    info.samples = info.light_samples = 1.0F;
    if (!cache_.has_light()) return;
    store(root(fresh.sampled), cache_.sampled(x, y));
    store(fresh.reflectance, cache_.reflectance(x, y));
  }

  HWY_ATTR void blend(int x, int y, Reason reason, const Fresh& fresh, CacheInfo& info) {
    const std::uint32_t age = job_.clock - info.touched;
    const float turned = share_turned(x, y, info);
    const bool full_rate = reason == Reason::Fovea && age > 0;
    const float limit = full_rate ? job_.config.fovea_weight : job_.color_limits.at(age);
    const float alpha =
        weight(info.samples, aged(limit, turned, job_.config.color_age), job_.config.weight);
    const FourVec color = clipped(x, y, reason, squared(load(cache_.color(x, y))));
    store(root(between(color, fresh.color, alpha)), cache_.color(x, y));
    info.samples = samples_after(info.samples, alpha);
    if (!cache_.has_light()) return;
    const float light_alpha =
        weight(info.light_samples, aged(job_.light_limits.at(age), turned, job_.config.light_age),
               job_.config.weight);
    mix_light(x, y, fresh, alpha, light_alpha);
    info.light_samples = samples_after(info.light_samples, light_alpha);
  }

  /// How much of what is remembered of a glossy point is no longer what the eye sees, [0, 1].
  float share_turned(int x, int y, const CacheInfo& info) const {
    if (!job_.glossy.any()) return 0.0F;
    return std::min(job_.glossy.turned(job_.view, {x, y}, job_.fresh, info.touched), 1.0F);
  }
  /// A memory that has turned away counts as one of full age.
  static float aged(float limit, float turned, const AgeLimits& limits) {
    return limit + turned * std::max(limits.most - limit, 0.0F);
  }

  /// Light per unit of reflectance goes by its own weight, what it meets by the colour's. A mean of
  /// light counts what met more reflectance for more.
  HWY_ATTR void mix_light(int x, int y, const Fresh& fresh, float alpha, float light_alpha) {
    const Four d;
    const FourVec before = load(cache_.reflectance(x, y)), one = hn::Set(d, 1.0F);
    const FourVec met = between(before, fresh.reflectance, light_alpha);
    const FourVec meets = between(before, fresh.reflectance, alpha);
    const FourVec kept = squared(load(cache_.sampled(x, y)));
    const FourVec brought = between(kept, fresh.sampled, light_alpha);
    const auto reflects = hn::Gt(met, hn::Zero(d));
    const FourVec share = hn::Div(hn::IfThenElse(reflects, meets, one),  //
                                  hn::IfThenElse(reflects, met, one));
    store(root(hn::Mul(brought, share)), cache_.sampled(x, y));
    store(meets, cache_.reflectance(x, y));
  }

  /// Chroma of the traced ones among a cell and those above and below it.
  struct Column {
    HWY_ALIGN float sum[4];
    HWY_ALIGN float squares[4];
    int x = -1, y = -1;
  };
  /// Where every cell is traced, the next one asks for two of these three columns again.
  HWY_ATTR const Column& column_around(int x, int y, int top, int bottom) {
    Column& column = columns_[x % 3];
    if (column.x == x && column.y == y) return column;
    const Four d;
    auto sum = hn::Zero(d), squares = hn::Zero(d);
    for (int j = top; j <= bottom; ++j) {
      // Chosen without a branch: which neighbours are traced is chance.
      const auto counts = hn::Set(d, job_.mask.traced(x, j) ? 1.0F : 0.0F);
      const auto value = hn::Mul(counts, hn::Load(d, &job_.fresh.chroma(job_.fresh.at(x, j)).r));
      sum = hn::Add(sum, value), squares = hn::MulAdd(value, value, squares);
    }
    hn::Store(sum, d, column.sum), hn::Store(squares, d, column.squares);
    column.x = x, column.y = y;
    return column;
  }

  /// Holds what is remembered within the spread of the new samples around, where there are three or
  /// more. Nothing is wrong with a memory of what did not move.
  HWY_ATTR FourVec clipped(int x, int y, Reason reason, FourVec remembered) {
    if (job_.config.clipping == Clipping::Off || job_.motion == Motion::Still) return remembered;
    const Four d;
    const int left = std::max(x - 1, 0), right = std::min(x + 1, radiance_.width() - 1);
    const int top = std::max(y - 1, 0), bottom = std::min(y + 1, radiance_.height() - 1);
    int count = 0;
    for (int j = top; j <= bottom; ++j) {
      for (int i = left; i <= right; ++i) count += job_.mask.traced(i, j) ? 1 : 0;
    }
    if (count < 3) return remembered;
    auto sum = hn::Zero(d), squares = hn::Zero(d);
    for (int i = left; i <= right; ++i) {
      const Column& column = column_around(i, y, top, bottom);
      sum = hn::Add(sum, hn::Load(d, column.sum));
      squares = hn::Add(squares, hn::Load(d, column.squares));
    }
    const auto share = hn::Set(d, 1.0F / static_cast<float>(count));
    const auto mean = hn::Mul(sum, share);
    const auto variance = hn::Max(hn::NegMulAdd(mean, mean, hn::Mul(squares, share)), hn::Zero(d));
    const float gamma = reason == Reason::Fovea ? job_.config.clip_fovea : job_.config.clip_outside;
    const auto reach = hn::Mul(hn::Set(d, gamma), hn::Sqrt(variance));
    const auto value = ycocg(remembered);
    return rgb(hn::Min(hn::Max(value, hn::Sub(mean, reach)), hn::Add(mean, reach)));
  }

  /// A cell without a past shows its sample to the bit.
  HWY_ATTR void show(int x, int y, const Fresh& fresh, const CacheInfo& info) {
    if (info.samples == 1.0F && info.light_samples == 1.0F) {
      radiance_(x, y) = fresh.radiance;
      return;
    }
    FourVec shown = squared(load(cache_.color(x, y)));
    if (cache_.has_light()) shown = hn::Add(shown, squared(load(cache_.sampled(x, y))));
    HWY_ALIGN float channels[4];
    hn::Store(shown, Four(), channels);
    radiance_(x, y) = {channels[0], channels[1], channels[2]};
  }

  const MergeJob& job_;
  Cache& cache_;
  Plane<Rgb>& radiance_;
  Column columns_[3];
};

HWY_ATTR void update_all(const MergeJob& job, std::span<const image::Pixel> cells, Cache& cache,
                         Plane<Rgb>& radiance) {
  Update update(job, cache, radiance);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i + kAhead < cells.size()) update.fetch(cells[i + kAhead].x, cells[i + kAhead].y);
    update.cell(cells[i].x, cells[i].y, DepthRows::of(cache.inverse_depth, cells[i].y));
  }
}

HWY_ATTR void update_columns(const MergeJob& job, int y, std::span<const int> columns,
                             const DepthRows& remembered, Cache& cache, Plane<Rgb>& radiance) {
  Update update(job, cache, radiance);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (i + kAhead < columns.size()) job.fresh.fetch(job.fresh.at(columns[i + kAhead], y));
    update.cell(columns[i], y, remembered);
  }
}

}  // namespace macula::kernels::ray::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::kernels::ray {

HWY_EXPORT(update_all);
HWY_EXPORT(update_columns);

void update_cells(const MergeJob& job, std::span<const image::Pixel> cells, Cache& cache,
                  Plane<Rgb>& radiance) {
  HWY_DYNAMIC_DISPATCH(update_all)(job, cells, cache, radiance);
}

void update_row(const MergeJob& job, int y, std::span<const int> columns,
                const DepthRows& remembered, Cache& cache, Plane<Rgb>& radiance) {
  HWY_DYNAMIC_DISPATCH(update_columns)(job, y, columns, remembered, cache, radiance);
}

}  // namespace macula::kernels::ray
#endif
