#include "server/kernels/ray/reproject.h"

#include <algorithm>
#include <cmath>

namespace macula::kernels::ray {

using reconstruction::Known;
using reconstruction::PictureRow;
using reconstruction::Reading;
using reconstruction::RowPlaces;
using reconstruction::RowReads;

namespace {

bool contains(const Plane<float>& plane, float x, float y) {
  return x >= 0.0F && y >= 0.0F && x < static_cast<float>(plane.width()) &&
         y < static_cast<float>(plane.height());
}

}  // namespace

Reprojector::Reprojector(const ReprojectJob& job, Cache& now)
    : job_(job),
      now_(now),
      warp_(job.view.world_from_view, job.view.grid, job.world_from_then, job.grid_then),
      taps_(job.then, job.view, job.config.filter, job.frame) {}

void Reprojector::find(int y, Row& row) const {
  row.y = y;
  row.inverse_depth.resize(job_.view.grid.width());
  job_.support.inverse_depth_row(y, row.inverse_depth);
  warp_.row(y, row.inverse_depth, row.places);
  if (!in_vectors()) {
    find_one_by_one(row);
    return;
  }
  judge(row.places, row.reads);
  list_open(row);
  follow(row);
  follow(row);
  try_corners(row);
  forget_unknown(row);
}

/// As printed a mesh shows what it is textured with, right or wrong.
bool Reprojector::in_vectors() const {
  return job_.config.warp == WarpKind::Verified &&
         job_.config.filter != HistoryFilter::NormalTaps && job_.then.color.width() > 1 &&
         job_.then.color.height() > 1;
}

void Reprojector::judge(const RowPlaces& places, RowReads& reads) const {
  const Reading reading =
      job_.config.filter == HistoryFilter::Bicubic ? Reading::Bicubic : Reading::Bilinear;
  reconstruction::judge_places({job_.then.inverse_depth, job_.config.merge_threshold, reading},
                               places, reads);
}

void Reprojector::list_open(Row& row) const {
  row.open.clear();
  for (int x = 0; x < job_.view.grid.width(); ++x) {
    if (row.reads.known[x] == Known::Nothing) row.open.push_back(x);
  }
}

/// Takes the depths that were found at the places instead of the ones that were looked for.
void Reprojector::follow(Row& row) const {
  row.columns.clear(), row.tried_depth.clear();
  for (const int x : row.open) {
    if (row.reads.known[x] != Known::Nothing) continue;
    const float depth = followed_depth(row, x);
    if (depth < 0.0F) continue;
    row.columns.push_back(x), row.tried_depth.push_back(depth);
  }
  try_again(row);
}

/// Inverse depth now of what lies at a cell's place; negative where there is nothing to follow.
float Reprojector::followed_depth(const Row& row, int x) const {
  const Plane<float>& depths = job_.then.inverse_depth;
  if (!(row.places.inverse_depth[x] >= 0.0F) ||
      !contains(depths, row.places.x[x], row.places.y[x])) {
    return -1.0F;
  }
  const int i = static_cast<int>(row.places.x[x]), j = static_cast<int>(row.places.y[x]);
  const float remembered = depths(i, j);
  return remembered < 0.0F ? -1.0F
                           : warp_.inverse_depth_now(job_.grid_then.tangent(i, j), remembered);
}

/// Between broken support samples a cell may lie at the depth of any of them, nearest first.
void Reprojector::try_corners(Row& row) const {
  std::vector<int> open;
  std::vector<std::array<float, 4>> corners;
  for (const int x : row.open) {
    if (row.reads.known[x] != Known::Nothing || !job_.support.broken_at(x, row.y)) continue;
    open.push_back(x), corners.push_back(job_.support.corners(x, row.y));
  }
  for (std::size_t corner = 0; corner < 4; ++corner) {
    row.columns.clear(), row.tried_depth.clear();
    for (std::size_t k = 0; k < open.size(); ++k) {
      if (row.reads.known[open[k]] != Known::Nothing) continue;
      row.columns.push_back(open[k]), row.tried_depth.push_back(corners[k][corner]);
    }
    try_again(row);
  }
}

/// Cells that are found at the tried depths keep them.
void Reprojector::try_again(Row& row) const {
  if (row.columns.empty()) return;
  row.tangent_x.clear();
  for (const int x : row.columns) row.tangent_x.push_back(warp_.tangents_x()[x]);
  warp_.row(row.y, row.tangent_x, row.tried_depth, row.tried_places);
  judge(row.tried_places, row.tried_reads);
  for (std::size_t k = 0; k < row.columns.size(); ++k) {
    const auto x = static_cast<std::size_t>(row.columns[k]);
    row.places.x[x] = row.tried_places.x[k], row.places.y[x] = row.tried_places.y[k];
    row.places.inverse_depth[x] = row.tried_places.inverse_depth[k];
    if (row.tried_reads.known[k] == Known::Nothing) continue;
    row.reads.copy(x, row.tried_reads, k);
    row.inverse_depth[x] = row.tried_depth[k];
  }
}

/// apply(then, now) for every plane there is of what is never filtered.
template <class Apply>
void Reprojector::for_each_unfiltered(const Apply& apply) const {
  const auto where_wanted = [&](const auto& then, auto& now) {
    if (!now.empty()) apply(then, now);
  };
  where_wanted(job_.then.info, now_.info);
  where_wanted(job_.then.surface_id, now_.surface_id);
  where_wanted(job_.then.normal, now_.normal);
  where_wanted(job_.then.albedo, now_.albedo);
}

void Reprojector::forget_unknown(Row& row) const {
  for (const int x : row.open) {
    if (row.reads.known[x] == Known::Nothing) row.inverse_depth[x] = Cache::kNothing;
  }
}

void Reprojector::write(const Row& row) const {
  std::ranges::copy(row.inverse_depth, now_.inverse_depth.row(row.y).begin());
  if (!in_vectors()) {
    read_one_by_one(row);
    return;
  }
  std::vector<PictureRow> rows{{job_.then.color, now_.color.row(row.y)}};
  if (now_.has_light()) {
    rows.push_back({job_.then.sampled, now_.sampled.row(row.y)});
    rows.push_back({job_.then.reflectance, now_.reflectance.row(row.y)});
  }
  reconstruction::read_row(row.reads, rows);
  // Cells of which nothing is known take what is somewhere: it is not read.
  for_each_unfiltered([&](const auto& then, auto& now) {
    const auto to = now.row(row.y);
    for (std::size_t x = 0; x < to.size(); ++x) to[x] = then.data()[row.reads.within[x]];
  });
}

/// The printed forms, and pictures of one column or row.
void Reprojector::find_one_by_one(Row& row) const {
  const Plane<float>& depths = job_.then.inverse_depth;
  for (int x = 0; x < job_.view.grid.width(); ++x) {
    const bool inside =
        row.places.inverse_depth[x] >= 0.0F && contains(depths, row.places.x[x], row.places.y[x]);
    if (!inside || depths.data()[place_then(row, x)] < 0.0F) row.inverse_depth[x] = Cache::kNothing;
  }
}

void Reprojector::read_one_by_one(const Row& row) const {
  for (int x = 0; x < job_.view.grid.width(); ++x) {
    if (row.inverse_depth[x] < 0.0F) continue;
    copy_info(x, row.y, place_then(row, x));
    const Taps taps = taps_.at(x, row.y, {row.places.x[x], row.places.y[x]});
    now_.color(x, row.y) = filtered(taps, job_.then.color);
    if (!now_.has_light()) continue;
    now_.sampled(x, row.y) = filtered(taps, job_.then.sampled);
    now_.reflectance(x, row.y) = filtered(taps, job_.then.reflectance);
  }
}

/// Index of the cell that contains the place, which lies in the picture.
std::size_t Reprojector::place_then(const Row& row, int x) const {
  const int i = static_cast<int>(row.places.x[x]), j = static_cast<int>(row.places.y[x]);
  return static_cast<std::size_t>(j) * job_.then.inverse_depth.width() + i;
}

void Reprojector::copy_info(int x, int y, std::size_t within) const {
  for_each_unfiltered([&](const auto& then, auto& now) { now(x, y) = then.data()[within]; });
}

}  // namespace macula::kernels::ray
