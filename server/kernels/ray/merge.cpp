#include "server/kernels/ray/merge.h"

#include <algorithm>
#include <cmath>

#include "server/kernels/ray/blend.h"
#include "server/kernels/ray/post_filter.h"
#include "server/scheduling/cpu_time.h"

namespace macula::kernels::ray {
namespace {

Texel mix(const Texel& remembered, const Rgb& fresh, float alpha) {
  return Texel(alpha * fresh + (1.0F - alpha) * remembered.rgb());
}

Rgb ycocg(const Rgb& c) {
  return {0.25F * c.x + 0.5F * c.y + 0.25F * c.z, 0.5F * c.x - 0.5F * c.z,
          -0.25F * c.x + 0.5F * c.y - 0.25F * c.z};
}
Rgb rgb_from_ycocg(const Rgb& c) {
  const float base = c.x - c.z;
  return {base + c.y, c.x + c.z, base - c.y};
}

/// least_weight() of every age below the full one.
class LimitTable {
 public:
  explicit LimitTable(const AgeLimits& limits) : most_(least_weight(limits, ~0U)) {
    for (int age = 0; age < limits.full_age; ++age) {
      weights_.push_back(least_weight(limits, static_cast<std::uint32_t>(age)));
    }
  }
  float at(std::uint32_t age) const { return age < weights_.size() ? weights_[age] : most_; }

 private:
  float most_;
  std::vector<float> weights_;
};

/// One cell's part of the cache update.
class Update {
 public:
  Update(const MergeJob& job, Cache& cache)
      : job_(job),
        cache_(cache),
        color_limits_(job.config.color_age),
        light_limits_(job.config.light_age) {}

  void cell(int x, int y) {
    CacheInfo& info = cache_.info(x, y);
    const Reason reason = job_.mask.reason(x, y);
    if (!cache_.remembers(x, y) || replaces(reason) || !same_surface(x, y)) {
      replace(x, y, info);
    } else {
      blend(x, y, reason, info);
    }
    info.touched = job_.clock;
    write_planes(x, y);
  }

 private:
  bool replaces(Reason reason) const {
    return job_.config.fresh == FreshRule::Replace &&
           (reason == Reason::Fovea || reason == Reason::Resampled);
  }
  Rgb fresh_color(int x, int y) const {
    const Rgb radiance = job_.fresh.radiance(x, y);
    if (!cache_.has_light()) return radiance;
    return glm::max(radiance - job_.fresh.light(x, y) * job_.fresh.reflectance(x, y), Rgb{0.0F});
  }

  /// Whether the new sample lies within the depths remembered of the cell and its neighbours: what
  /// an edge pixel shows changes with the jitter. The printed test holds it against its own alone.
  bool same_surface(int x, int y) const {
    const float fresh = 1.0F / job_.fresh.depth_m(x, y);
    const int reach = job_.config.fresh == FreshRule::Replace ? 0 : 1;
    float low = INFINITY, high = 0.0F;
    for (int j = y - reach; j <= y + reach; ++j) {
      for (int i = x - reach; i <= x + reach; ++i) {
        if (!cache_.info.contains(i, j) || !cache_.remembers(i, j)) continue;
        low = std::min(low, cache_.inverse_depth(i, j));
        high = std::max(high, cache_.inverse_depth(i, j));
      }
    }
    const float slack = job_.config.merge_threshold;
    return fresh >= low - slack * low && fresh <= high + slack * std::max(high, fresh);
  }

  void replace(int x, int y, CacheInfo& info) {
    cache_.color(x, y) = Texel(fresh_color(x, y));
    info.samples = info.light_samples = 1.0F;
    if (!cache_.has_light()) return;
    cache_.light(x, y) = Texel(job_.fresh.light(x, y));
    cache_.reflectance(x, y) = Texel(job_.fresh.reflectance(x, y));
  }

  void blend(int x, int y, Reason reason, CacheInfo& info) {
    const std::uint32_t age = job_.clock - info.touched;
    const bool full_rate = reason == Reason::Fovea && age > 0;
    const float limit = full_rate ? job_.config.fovea_weight : color_limits_.at(age);
    const float alpha = weight(info.samples, limit, job_.config.weight);
    Texel& color = cache_.color(x, y);
    color = mix(clipped(x, y, reason, color), fresh_color(x, y), alpha);
    info.samples = samples_after(info.samples, alpha);
    if (!cache_.has_light()) return;
    const float light_alpha = weight(info.light_samples, light_limits_.at(age), job_.config.weight);
    cache_.reflectance(x, y) = mix(cache_.reflectance(x, y), job_.fresh.reflectance(x, y), alpha);
    cache_.light(x, y) = mix(cache_.light(x, y), job_.fresh.light(x, y), light_alpha);
    info.light_samples = samples_after(info.light_samples, light_alpha);
  }

  /// What is remembered, held within the spread of the new samples around, where there are three or
  /// more. Nothing is wrong with a memory of what did not move.
  Texel clipped(int x, int y, Reason reason, const Texel& remembered) const {
    if (job_.config.clipping == Clipping::Off || job_.motion == Motion::Still) return remembered;
    Rgb sum{0.0F}, squares{0.0F};
    int count = 0;
    for (int j = y - 1; j <= y + 1; ++j) {
      for (int i = x - 1; i <= x + 1; ++i) {
        if (!job_.mask.contains(i, j) || !job_.mask.traced(i, j)) continue;
        const Rgb value = ycocg(fresh_color(i, j));
        sum += value, squares += value * value, ++count;
      }
    }
    if (count < 3) return remembered;
    const Rgb mean = sum / static_cast<float>(count);
    const Rgb variance = glm::max(squares / static_cast<float>(count) - mean * mean, Rgb{0.0F});
    const float gamma = reason == Reason::Fovea ? job_.config.clip_fovea : job_.config.clip_outside;
    const Rgb reach = gamma * glm::sqrt(variance);
    return Texel(rgb_from_ycocg(glm::clamp(ycocg(remembered.rgb()), mean - reach, mean + reach)));
  }

  void write_planes(int x, int y) {
    if (!cache_.surface_id.empty()) cache_.surface_id(x, y) = job_.fresh.surface_id(x, y);
    if (!cache_.normal.empty()) cache_.normal(x, y) = job_.fresh.normal(x, y);
    if (!cache_.albedo.empty()) cache_.albedo(x, y) = job_.fresh.albedo(x, y);
  }

  const MergeJob& job_;
  Cache& cache_;
  LimitTable color_limits_, light_limits_;
};

/// Bilinear between the support cells, whose own cache is up to date.
template <class T, class Fetch>
T between_support(const Support& support, int x, int y, const Fetch& fetch) {
  const int left = support.x.cells[support.x.left[x]], right = support.x.cells[support.x.right(x)];
  const int top = support.y.cells[support.y.left[y]], bottom = support.y.cells[support.y.right(y)];
  const float across = std::clamp(support.x.fraction[x], 0.0F, 1.0F);
  const float down = std::clamp(support.y.fraction[y], 0.0F, 1.0F);
  const T upper = (1.0F - across) * fetch(left, top) + across * fetch(right, top);
  const T lower = (1.0F - across) * fetch(left, bottom) + across * fetch(right, bottom);
  return (1.0F - down) * upper + down * lower;
}

class Writer {
 public:
  Writer(const MergeJob& job, Cache& cache, ViewBuffers& out)
      : job_(job), cache_(cache), out_(out) {}

  WriteCounts rows(int first, int last) {
    support_depth_.resize(cache_.color.width());
    for (int y = first; y < last; ++y) {
      job_.support.inverse_depth_row(y, support_depth_);
      for (int x = 0; x < cache_.color.width(); ++x) cell(x, y);
    }
    if (job_.config.post_filter == PostFilter::On && cache_.has_light()) post_filter(first, last);
    return counts_;
  }

 private:
  void cell(int x, int y) {
    CacheInfo& info = cache_.info(x, y);
    const bool traced = job_.mask.traced(x, y);
    if (traced) {
      const float depth = job_.fresh.depth_m(x, y);
      out_.depth_m(x, y) = depth;
      cache_.inverse_depth(x, y) = 1.0F / depth;
    } else if (cache_.remembers(x, y)) {
      out_.depth_m(x, y) = 1.0F / cache_.inverse_depth(x, y);
    } else {
      fill(x, y);
      out_.depth_m(x, y) = 1.0F / support_depth_[x];
    }
    const bool alone = traced && info.samples == 1.0F && info.light_samples == 1.0F;
    out_.radiance(x, y) = alone ? job_.fresh.radiance(x, y) : shown(x, y);
    if (!out_.surface_id.empty()) out_.surface_id(x, y) = cache_.surface_id(x, y);
    if (!out_.normal.empty()) out_.normal(x, y) = cache_.normal(x, y);
    if (!out_.albedo.empty()) out_.albedo(x, y) = cache_.albedo(x, y);
    if (!out_.samples.empty()) out_.samples(x, y) = info.samples;
    if (!out_.variance.empty()) out_.variance(x, y) = INFINITY;
  }

  void post_filter(int first, int last) {
    const double begin = scheduling::thread_cpu_ms();
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < cache_.color.width(); ++x) {
        if (job_.mask.reason(x, y) != Reason::Resampled) continue;
        out_.radiance(x, y) = cache_.color(x, y).rgb() +
                              cache_.reflectance(x, y).rgb() * neighbours_light(job_, cache_, x, y);
      }
    }
    counts_.post_ms += scheduling::thread_cpu_ms() - begin;
  }

  Rgb shown(int x, int y) const {
    const Rgb color = cache_.color(x, y).rgb();
    if (!cache_.has_light()) return color;
    return color + cache_.reflectance(x, y).rgb() * cache_.light(x, y).rgb();
  }

  void fill(int x, int y) {
    ++counts_.filled;
    cache_.info(x, y) = CacheInfo{};
    const auto of = [&](const Plane<Texel>& plane) {
      return Texel(between_support<Rgb>(job_.support, x, y,
                                        [&](int i, int j) { return plane(i, j).rgb(); }));
    };
    cache_.color(x, y) = of(cache_.color);
    if (cache_.has_light()) {
      cache_.light(x, y) = of(cache_.light);
      cache_.reflectance(x, y) = of(cache_.reflectance);
    }
    const int near_x = nearest(job_.support.x, x), near_y = nearest(job_.support.y, y);
    if (!cache_.surface_id.empty()) cache_.surface_id(x, y) = cache_.surface_id(near_x, near_y);
    if (!cache_.normal.empty()) cache_.normal(x, y) = cache_.normal(near_x, near_y);
    if (!cache_.albedo.empty()) cache_.albedo(x, y) = cache_.albedo(near_x, near_y);
  }
  static int nearest(const SupportAxis& axis, int cell) {
    return axis.cells[axis.fraction[cell] < 0.5F ? axis.left[cell] : axis.right(cell)];
  }

  const MergeJob& job_;
  Cache& cache_;
  ViewBuffers& out_;
  WriteCounts counts_;
  std::vector<float> support_depth_;
};

}  // namespace

void update_cache(const MergeJob& job, std::span<const image::Pixel> cells, Cache& cache) {
  Update update(job, cache);
  for (const image::Pixel& cell : cells) update.cell(cell.x, cell.y);
}

WriteCounts write_frame(const MergeJob& job, int first, int last, Cache& cache, ViewBuffers& out) {
  return Writer(job, cache, out).rows(first, last);
}

}  // namespace macula::kernels::ray
