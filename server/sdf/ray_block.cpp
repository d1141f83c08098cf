#include "server/sdf/ray_block.h"

#include <algorithm>
#include <limits>

namespace macula::sdf {
namespace {

RayStatus status_of(LaneState state) {
  switch (state) {
    case LaneState::Hit:
      return RayStatus::Hit;
    case LaneState::Miss:
      return RayStatus::Miss;
    case LaneState::Inside:
      return RayStatus::Inside;
    case LaneState::Broken:
      return RayStatus::Broken;
    default:
      return RayStatus::Capped;
  }
}

class Aim {
 public:
  Aim(const RayBlock& block, TraceScratch& scratch) : b_(block), s_(scratch) {
    for (int i = 0; i < block.samples; ++i) offsets_.push_back(sample_offset(i, block.samples));
  }

  std::size_t run() {
    const std::size_t most = s_.wanted.size() * offsets_.size();
    s_.rays.resize(most);
    s_.widths.resize(most);
    s_.block.hits.resize(most);
    std::size_t rays = 0, cell = 0;
    for (int y = 0; y < b_.cells.height; ++y) {
      for (int x = 0; x < b_.cells.width; ++x) {
        if (s_.wanted[cell++] != 0) rays = aim(b_.cells.x + x, b_.cells.y + y, rays);
      }
    }
    s_.block.hits.resize(rays);
    s_.results.resize(std::max(s_.results.size(), rays));
    s_.rays.point_along(rays, b_.scene_from_view);
    return rays;
  }

 private:
  std::size_t aim(int column, int row, std::size_t ray) {
    const Vec2 size = b_.grid.footprint(column, row);
    for (std::size_t i = 0; i < offsets_.size(); ++i, ++ray) {
      const Vec2 tangent = b_.grid.tangent(column, row, offsets_[i].x, offsets_[i].y);
      s_.rays.tangent_x[ray] = tangent.x, s_.rays.tangent_y[ray] = tangent.y;
      // Half the cell's lesser side, seen from the eye: at most its width across the ray.
      const float square = 1.0F + tangent.x * tangent.x + tangent.y * tangent.y;
      s_.widths[ray] =
          std::min(b_.hit_pixels * 0.5F * std::min(size.x, size.y) / square, kMostHitWidth);
      Hit& hit = s_.block.hits[ray];
      hit.x = static_cast<std::uint16_t>(column), hit.y = static_cast<std::uint16_t>(row);
      hit.sample = static_cast<std::uint8_t>(i);
    }
    return ray;
  }

  const RayBlock& b_;
  TraceScratch& s_;
  std::vector<Vec2> offsets_;
};

}  // namespace

std::size_t aim_rays(const RayBlock& block, TraceScratch& scratch) {
  return Aim(block, scratch).run();
}

void send_rays(std::size_t first, std::size_t count, float start, TraceScratch& scratch) {
  LaneQueue& queue = scratch.block_slabs.of(start, scratch.registers).waiting;
  const Directions& rays = scratch.rays;
  queue.push(rays.x + first, rays.y + first, rays.z + first, scratch.widths.data() + first, count,
             start, static_cast<std::uint32_t>(first), scratch.pool);
}

void drop_rays(std::size_t first, std::size_t count, TraceScratch& scratch) {
  std::fill_n(scratch.results.begin() + static_cast<std::ptrdiff_t>(first), count, LaneResult{});
}

void take_results(TraceScratch& scratch, TraceCounts& counts) {
  for (std::size_t i = 0; i < scratch.block.hits.size(); ++i) {
    const LaneResult& result = scratch.results[i];
    Hit& hit = scratch.block.hits[i];
    hit.direction = scratch.rays[i];
    hit.steps = result.steps;
    hit.t = result.at;
    hit.status = status_of(result.state);
    hit.material = -1;
    hit.normal = Vec3{0.0F};
    if (hit.status == RayStatus::Hit) continue;
    if (hit.status == RayStatus::Miss) hit.t = std::numeric_limits<float>::infinity();
    if (hit.status == RayStatus::Inside) hit.normal = -hit.direction;
    counts.capped += hit.status == RayStatus::Capped;
    counts.inside += hit.status == RayStatus::Inside;
    counts.broken += hit.status == RayStatus::Broken;
  }
}

}  // namespace macula::sdf
