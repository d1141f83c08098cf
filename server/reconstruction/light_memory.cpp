#include "server/reconstruction/light_memory.h"

#include <algorithm>
#include <cmath>

#include "shared/image/color.h"

namespace macula::reconstruction {
namespace {

/// Frames from which their own spread says more of the noise than what lies around.
constexpr float kEnoughFrames = 4.0F;

Vec3 position_in(const SurfacePlanes& s, int x, int y) {
  return {s.x.row(y)[x], s.y.row(y)[x], s.z.row(y)[x]};
}
Vec3 normal_in(const SurfacePlanes& s, int x, int y) {
  return {s.normal_x.row(y)[x], s.normal_y.row(y)[x], s.normal_z.row(y)[x]};
}

}  // namespace

/// What a cell was in the last frame, or a mean of several.
struct MemoryJoin::Cell {
  float r = 0.0F, g = 0.0F, b = 0.0F, square = 0.0F, recent = 0.0F, samples = 0.0F;

  void add(float weight, const LightMemory& from, int x, int y, float worth) {
    r += weight * from.mean.r.row(y)[x], g += weight * from.mean.g.row(y)[x];
    b += weight * from.mean.b.row(y)[x], square += weight * from.square.row(y)[x];
    recent += weight * from.recent.row(y)[x];
    samples += weight * worth * from.samples.row(y)[x];
  }
  void scale(float by) {
    for (float* value : {&r, &g, &b, &square, &recent, &samples}) *value *= by;
  }
};

MemoryJoin::MemoryJoin(const LightMemory* last, const MemoryConfig& config, LightMemory& now)
    : last_(last), config_(config), now_(now), areas_now_(now.grid) {
  if (last_ != nullptr) {
    warp_.emplace(now.world_from_view, now.grid, last_->world_from_view, last_->grid);
    areas_then_ = CellAreas(last_->grid);
  }
  for (WidePlane* plane :
       {&now.square, &now.recent, &now.samples, &around_mean_.mean, &around_mean_.deviation,
        &around_recent_.mean, &around_recent_.deviation}) {
    plane->resize_as(now.mean.r);
  }
  places_.resize(static_cast<std::size_t>(now.surfaces.height()));
}

MemoryJoin::Span MemoryJoin::locate_row(int y) {
  if (!warp_) return {};
  RowPlaces& places = places_[static_cast<std::size_t>(y)];
  places = places_of(y);
  const int width = last_->surfaces.width(), height = last_->surfaces.height();
  Span span{height, 0};
  for (std::size_t i = 0; i < places.y.size(); ++i) {
    if (!(places.inverse_depth[i] > 0.0F)) continue;
    const float above = std::floor(places.y[i] - 0.5F);
    if (!(above >= -1.0F && above < static_cast<float>(height))) continue;
    if (!(places.x[i] > -0.5F && places.x[i] < static_cast<float>(width) + 0.5F)) continue;
    span.begin = std::min(span.begin, std::max(static_cast<int>(above), 0));
    span.end = std::max(span.end, std::min(static_cast<int>(above) + 2, height));
  }
  return span;
}

void MemoryJoin::join_row(int y) {
  const auto row = static_cast<std::size_t>(y);
  if (warp_ && places_[row].x.empty()) places_[row] = places_of(y);
  const RowPlaces& places = places_[row];
  for (int x = 0; x < now_.surfaces.width(); ++x) {
    if (!(now_.surfaces.distance_m.row(y)[x] > 0.0F)) continue;
    join(x, y, warp_ ? recalled(places, x, y) : Cell{});
  }
}

void MemoryJoin::bound_row(int y) {
  spread_row(now_.surfaces.distance_m, now_.recent, y, around_recent_);
  for (int x = 0; x < now_.surfaces.width(); ++x) {
    if (now_.samples.row(y)[x] > now_.fresh.row(y)[x]) bound(x, y);
  }
}

void MemoryJoin::judge_row(int y) {
  spread_row(now_.surfaces.distance_m, now_.mean.luminance, y, around_mean_);
  for (int x = 0; x < now_.surfaces.width(); ++x) {
    if (!(now_.samples.row(y)[x] > 0.0F)) continue;
    const float frames = now_.frames(x, y), mean = now_.mean.luminance.row(y)[x];
    const float own = std::max(now_.square.row(y)[x] - mean * mean, 0.0F) / frames;
    const float around = around_mean_.deviation.row(y)[x];
    now_.mean.variance.row(y)[x] = frames < kEnoughFrames ? around * around : own;
  }
}

RowPlaces MemoryJoin::places_of(int y) const {
  std::vector<float> inverse_depth(static_cast<std::size_t>(now_.surfaces.width()));
  const Vec3 ahead(-glm::mat3_cast(now_.world_from_view.rotation)[2]);
  const Vec3 eye(now_.world_from_view.position);
  for (int x = 0; x < now_.surfaces.width(); ++x) {
    if (!(now_.surfaces.distance_m.row(y)[x] > 0.0F)) continue;
    const float depth = glm::dot(position_in(now_.surfaces, x, y) - eye, ahead);
    if (depth > 0.0F) inverse_depth[static_cast<std::size_t>(x)] = 1.0F / depth;
  }
  RowPlaces places;
  warp_->row(y, inverse_depth, places);
  return places;
}

/// Of the four cells around its place that show the same surface.
MemoryJoin::Cell MemoryJoin::recalled(const RowPlaces& places, int x, int y) const {
  const auto i = static_cast<std::size_t>(x);
  if (!(places.inverse_depth[i] > 0.0F)) return {};
  const float px = places.x[i] - 0.5F, py = places.y[i] - 0.5F;
  const auto width = static_cast<float>(last_->surfaces.width());
  const auto height = static_cast<float>(last_->surfaces.height());
  if (!(px > -1.0F && px < width && py > -1.0F && py < height)) return {};
  const int left = static_cast<int>(std::floor(px)), top = static_cast<int>(std::floor(py));
  const float fx = px - static_cast<float>(left), fy = py - static_cast<float>(top);
  Cell cell;
  float sum = 0.0F;
  for (int k = 0; k < 4; ++k) {
    const int then_x = left + k % 2, then_y = top + k / 2;
    const float weight = (k % 2 == 0 ? 1.0F - fx : fx) * (k / 2 == 0 ? 1.0F - fy : fy);
    if (!(weight > 0.0F) || !shows_same(x, y, then_x, then_y)) continue;
    cell.add(weight, *last_, then_x, then_y,
             worth(areas_now_.at(x, y), areas_then_.at(then_x, then_y)));
    sum += weight;
  }
  constexpr float kLeastShare = 0.01F;
  if (sum < kLeastShare) return {};
  cell.scale(1.0F / sum);
  return cell;
}

bool MemoryJoin::shows_same(int x, int y, int then_x, int then_y) const {
  const SurfacePlanes& then = last_->surfaces;
  if (then_x < 0 || then_y < 0 || then_x >= then.width() || then_y >= then.height()) return false;
  if (!(then.distance_m.row(then_y)[then_x] > 0.0F)) return false;
  const Vec3 normal = normal_in(now_.surfaces, x, y);
  if (glm::dot(normal, normal_in(then, then_x, then_y)) < kLeastFacing) return false;
  const Vec3 between = position_in(then, then_x, then_y) - position_in(now_.surfaces, x, y);
  const float allowed = kApartOfBetween * glm::length(between) +
                        kApartOfDistance * now_.surfaces.distance_m.row(y)[x];
  return std::abs(glm::dot(normal, between)) <= allowed;
}

void MemoryJoin::join(int x, int y, const Cell& old) {
  const auto blend = [](float from, float to, float share) { return from + share * (to - from); };
  LightPlanes& mean = now_.mean;
  const float fresh = mean.luminance.row(y)[x];
  const float own = now_.fresh.row(y)[x];
  const float most = std::min(config_.most_frames * own, std::max(config_.most_samples, own));
  const float samples = std::min(old.samples + own, most);
  const float share = own / samples;
  float& r = mean.r.row(y)[x];
  float& g = mean.g.row(y)[x];
  float& b = mean.b.row(y)[x];
  r = blend(old.r, r, share), g = blend(old.g, g, share), b = blend(old.b, b, share);
  mean.luminance.row(y)[x] = image::luminance({r, g, b});
  now_.square.row(y)[x] = blend(old.square, fresh * fresh, share);
  now_.recent.row(y)[x] = blend(old.recent, fresh, std::max(share, 1.0F / config_.recent_frames));
  now_.samples.row(y)[x] = samples;
}

void MemoryJoin::bound(int x, int y) {
  float& mean = now_.mean.luminance.row(y)[x];
  const float middle = around_recent_.mean.row(y)[x];
  const float off = config_.deviations * around_recent_.deviation.row(y)[x];
  const float held = std::clamp(mean, middle - off, middle + off);
  if (held == mean || !(mean > 0.0F)) return;
  const float scale = held / mean;
  for (WidePlane* plane : {&now_.mean.r, &now_.mean.g, &now_.mean.b}) plane->row(y)[x] *= scale;
  now_.square.row(y)[x] *= scale * scale;
  mean = held;
  float& samples = now_.samples.row(y)[x];
  samples = std::min(samples, config_.recent_frames * now_.fresh.row(y)[x]);
}

}  // namespace macula::reconstruction
