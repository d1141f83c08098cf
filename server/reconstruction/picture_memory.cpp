#include "server/reconstruction/picture_memory.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace macula::reconstruction {

PictureJoin::PictureJoin(const PictureMemory* last, const SteadyConfig& config,
                         const image::Plane<Rgb>& fresh, const image::Plane<float>& inverse_depth,
                         PictureMemory& now)
    : last_(last),
      config_(config),
      fresh_(fresh),
      inverse_depth_(inverse_depth),
      now_(now),
      fresh_roots_(fresh.width(), fresh.height()),
      areas_now_(now.grid) {
  now.roots.resize(fresh.width(), fresh.height());
  now.frames.resize(fresh.width(), fresh.height(), 1.0F);
  if (last == nullptr || last->roots.width() < 2 || last->roots.height() < 2) return;
  areas_then_ = CellAreas(last->grid);
  anything_.resize(last->roots.width(), last->roots.height(), 0.0F);
  warp_.emplace(now.world_from_view, now.grid, last->world_from_view, last->grid);
  places_.resize(static_cast<std::size_t>(fresh.height()));
}

void PictureJoin::follow(const Movers& movers) {
  if (!warp_) return;
  movers_ = &movers;
  for (const Pose& then_from_now : movers.then_from_now)
    carried_.emplace_back(then_from_now * now_.world_from_view, last_->world_from_view);
}

PictureJoin::Span PictureJoin::locate_row(int y) {
  if (!warp_) return {};
  RowPlaces& places = places_[static_cast<std::size_t>(y)];
  places = places_of(y);
  constexpr int kTaps = 2;  // of a cubic, on either side
  const int height = last_->roots.height();
  Span span{height, 0};
  for (std::size_t i = 0; i < places.y.size(); ++i) {
    const float at = std::floor(places.y[i]);
    if (!(at >= -1.0F && at <= static_cast<float>(height))) continue;
    span.begin = std::min(span.begin, std::max(static_cast<int>(at) - kTaps, 0));
    span.end = std::max(span.end, std::min(static_cast<int>(at) + kTaps + 1, height));
  }
  return span;
}

void PictureJoin::prepare_row(int y) {
  for (int x = 0; x < fresh_.width(); ++x) {
    fresh_roots_(x, y) = Texel(glm::sqrt(glm::max(fresh_(x, y), Rgb{0.0F})));
  }
}

void PictureJoin::join_row(int y, std::span<Rgb> shown) {
  Row before;
  if (warp_) before = read(y);
  for (int x = 0; x < fresh_.width(); ++x) {
    const auto i = static_cast<std::size_t>(x);
    const Rgb fresh = glm::max(fresh_(x, y), Rgb{0.0F});
    shown[i] = fresh;
    if (warp_ && before.reads.known[i] != Known::Nothing) {
      const Bounds bounds = around(x, y);
      const Rgb held = glm::clamp(before.roots[i].rgb(), bounds.low, bounds.high);
      now_.frames(x, y) = std::min(frames(before, x, y) + 1.0F, config_.most_frames);
      shown[i] = glm::mix(held * held, fresh, 1.0F / now_.frames(x, y));
    }
    now_.roots(x, y) = Texel(glm::sqrt(shown[i]));
  }
}

RowPlaces PictureJoin::places_of(int y) const {
  const auto width = static_cast<std::size_t>(fresh_.width());
  std::vector<float> inverse_depth(width);
  std::vector<std::pair<std::size_t, std::uint32_t>> moved;  // cells, and who moved them
  for (std::size_t i = 0; i < width; ++i) {
    const Front front = nearest(static_cast<int>(i), y);
    inverse_depth[i] = front.inverse_depth;
    const std::uint32_t mover = movers_ != nullptr ? movers_->of(front.x, front.y) : 0;
    if (mover > 0) moved.emplace_back(i, mover - 1);
  }
  RowPlaces places;
  warp_->row(y, inverse_depth, places);
  for (const auto& [i, mover] : moved) {
    const RowWarp::Place then =
        warp_->then(static_cast<int>(i), y, inverse_depth[i], carried_[mover]);
    places.x[i] = then.x, places.y[i] = then.y, places.inverse_depth[i] = then.inverse_depth;
  }
  for (float& w : places.inverse_depth) w = std::min(w, 0.0F);  // negative: behind the eye then
  return places;
}

PictureJoin::Row PictureJoin::read(int y) {
  RowPlaces& places = places_[static_cast<std::size_t>(y)];
  if (places.x.empty()) places = places_of(y);
  Row row;
  judge_places({anything_}, places, row.reads);
  row.roots.resize(places.x.size());
  const PictureRow roots{last_->roots, row.roots};
  read_row(row.reads, {&roots, 1});
  return row;
}

/// Of the cell that was there, by its size.
float PictureJoin::frames(const Row& row, int x, int y) const {
  const int then = row.reads.within[static_cast<std::size_t>(x)];
  const int width = last_->frames.width();
  const int then_x = then % width, then_y = then / width;
  return last_->frames(then_x, then_y) * worth(areas_now_.at(x, y), areas_then_.at(then_x, then_y));
}

/// The surface in front moves edges.
PictureJoin::Front PictureJoin::nearest(int x, int y) const {
  Front front{0.0F, x, y};
  for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, fresh_.height() - 1); ++ny) {
    for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, fresh_.width() - 1); ++nx) {
      if (inverse_depth_(nx, ny) > front.inverse_depth) front = {inverse_depth_(nx, ny), nx, ny};
    }
  }
  return front;
}

PictureJoin::Bounds PictureJoin::around(int x, int y) const {
  Vec3 sum{0.0F}, square{0.0F};
  float count = 0.0F;
  for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, fresh_.height() - 1); ++ny) {
    for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, fresh_.width() - 1); ++nx) {
      const Vec3 root = fresh_roots_(nx, ny).rgb();
      sum += root, square += root * root, count += 1.0F;
    }
  }
  const Vec3 mean = sum / count;
  const Vec3 off =
      config_.deviations * glm::sqrt(glm::max(square / count - mean * mean, Vec3{0.0F}));
  return {mean - off, mean + off};
}

}  // namespace macula::reconstruction
