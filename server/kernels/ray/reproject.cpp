#include "server/kernels/ray/reproject.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace macula::kernels::ray {

Reprojector::Reprojector(const ReprojectJob& job, Cache& now)
    : job_(job),
      now_(now),
      warp_(job.view.world_from_view, job.view.grid, job.world_from_then, job.grid_then),
      taps_(job.then, job.view, job.config.filter, job.frame) {}

void Reprojector::rows(int first, int last) const {
  std::vector<float> inverse_depth(job_.view.grid.width());
  reconstruction::RowPlaces places;
  for (int y = first; y < last; ++y) {
    job_.support.inverse_depth_row(y, inverse_depth);
    warp_.row(y, inverse_depth, places);
    for (int x = 0; x < job_.view.grid.width(); ++x) {
      const Place guess{places.x[x], places.y[x], places.inverse_depth[x]};
      write(x, y, find(x, y, guess, inverse_depth[x]));
    }
  }
}

auto Reprojector::find(int x, int y, const Place& guess, float guessed_depth) const
    -> std::optional<Found> {
  if (job_.config.warp == WarpKind::Mesh) {
    // A mesh shows what it is textured with, right or wrong.
    if (!inside(guess) || depth_at(guess) < 0.0F) return std::nullopt;
    return Found{guess, guessed_depth};
  }
  if (agrees(guess)) return Found{guess, guessed_depth};
  if (const auto found = follow(x, y, guess)) return found;
  if (!job_.support.broken_at(x, y)) return std::nullopt;
  for (const float corner : job_.support.corners(x, y)) {
    const Place place = warp_.then(x, y, corner);
    if (agrees(place)) return Found{place, corner};
  }
  return std::nullopt;
}

/// Takes the depth that was found at the place instead of the guessed one, twice.
auto Reprojector::follow(int x, int y, Place place) const -> std::optional<Found> {
  for (int step = 0; step < 2; ++step) {
    if (!inside(place)) return std::nullopt;
    const float remembered = depth_at(place);
    if (remembered < 0.0F) return std::nullopt;
    const Vec2 tangent =
        job_.grid_then.tangent(static_cast<int>(place.x), static_cast<int>(place.y));
    const float depth = warp_.inverse_depth_now(tangent, remembered);
    if (depth < 0.0F) return std::nullopt;
    place = warp_.then(x, y, depth);
    if (agrees(place)) return Found{place, depth};
  }
  return std::nullopt;
}

bool Reprojector::inside(const Place& place) const {
  return place.inverse_depth >= 0.0F && place.x >= 0.0F && place.y >= 0.0F &&
         place.x < static_cast<float>(job_.then.color.width()) &&
         place.y < static_cast<float>(job_.then.color.height());
}

float Reprojector::depth_at(const Place& place) const {
  return job_.then.inverse_depth(static_cast<int>(place.x), static_cast<int>(place.y));
}

bool Reprojector::agrees(const Place& place) const {
  if (!inside(place)) return false;
  const float remembered = depth_at(place);
  const float largest = std::max(remembered, place.inverse_depth);
  return remembered >= 0.0F &&
         std::abs(remembered - place.inverse_depth) <= job_.config.merge_threshold * largest;
}

void Reprojector::write(int x, int y, const std::optional<Found>& found) const {
  if (!found) {
    now_.inverse_depth(x, y) = Cache::kNothing;
    return;
  }
  const int there_x = static_cast<int>(found->place.x), there_y = static_cast<int>(found->place.y);
  now_.inverse_depth(x, y) = found->inverse_depth_now;
  now_.info(x, y) = job_.then.info(there_x, there_y);
  const Taps taps = taps_.at(x, y, {found->place.x, found->place.y});
  now_.color(x, y) = filtered(taps, job_.then.color);
  if (now_.has_light()) {
    now_.light(x, y) = filtered(taps, job_.then.light);
    now_.reflectance(x, y) = filtered(taps, job_.then.reflectance);
  }
  if (!now_.surface_id.empty()) now_.surface_id(x, y) = job_.then.surface_id(there_x, there_y);
  if (!now_.normal.empty()) now_.normal(x, y) = job_.then.normal(there_x, there_y);
  if (!now_.albedo.empty()) now_.albedo(x, y) = job_.then.albedo(there_x, there_y);
}

}  // namespace macula::kernels::ray
