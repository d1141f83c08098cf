#include "server/kernels/lightcuts/surfaces.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "server/kernels/lightcuts/surface_parcel.h"
#include "server/kernels/ray/shading_point.h"
#include "server/kernels/ray/surface_stage.h"

namespace macula::kernels::lightcuts {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kBlock = 4;  ///< neighbours of one packet

struct Shot {
  const FrameRequest& request;
  const View& view;
  const SceneFrame& scene;
  const ray::Config& config;
  ray::CellPattern pattern;
  unsigned wanted;
  Mat3 world_from_view;
  Vec3 eye;

  Shot(const FrameRequest& asked, const View& shown, const SceneFrame& frame_scene,
       const ray::Config& settings, unsigned planes)
      : request(asked),
        view(shown),
        scene(frame_scene),
        config(settings),
        pattern(1, settings.placement),
        wanted(planes),
        world_from_view(glm::mat3_cast(shown.world_from_view.rotation)),
        eye(shown.world_from_view.position) {}
};

class TileShot {
 public:
  TileShot(const Shot& shot, SurfaceTile& tile, ViewBuffers& out)
      : shot_(shot), tile_(tile), out_(out) {}

  FrameReport run() {
    const auto begin = std::chrono::steady_clock::now();
    aim();
    shot_.scene.intersect(rays_, hits_, visibility::Coherence::Coherent);
    const auto traced = std::chrono::steady_clock::now();
    gather();
    FrameReport report;
    report.primary_rays = static_cast<std::uint64_t>(rays_.count);
    report.trace_ms = units::to_ms(traced - begin);
    report.shade_ms = units::to_ms(std::chrono::steady_clock::now() - traced);
    return report;
  }

 private:
  /// Rays in blocks, so that every packet is a small square of neighbours.
  void aim() {
    rays_.clear();
    const image::Rect& rect = tile_.rect;
    for (int by = 0; by < rect.height; by += kBlock) {
      for (int bx = 0; bx < rect.width; bx += kBlock) {
        for (int y = by; y < std::min(by + kBlock, rect.height); ++y) {
          for (int x = bx; x < std::min(bx + kBlock, rect.width); ++x) aim_at(x, y);
        }
      }
    }
  }
  void aim_at(int x, int y) {
    const PixelGrid& grid = shot_.view.grid;
    const int gx = tile_.rect.x + x, gy = tile_.rect.y + y;
    const auto ray = static_cast<std::size_t>(rays_.count);
    keys_[ray] = {shot_.request.seed, shot_.request.frame, grid.cell_key(gx, gy)};
    cells_[ray] = static_cast<std::uint16_t>(SurfaceTile::cell_index(x, y));
    const Vec2 at = shot_.pattern.position(keys_[ray], 0);
    rays_.push(shot_.eye, shot_.world_from_view * grid.ray(gx, gy, at.x, at.y), 0.0F, kInfinity);
  }

  void gather() {
    tile_.points.clear();
    tile_.points.sample = 0;
    tile_.points.keeps_whole = shot_.scene.plan().has(scene::Step::Environment);
    tile_.point_of.fill(SurfaceTile::kNone);
    const bool in_vectors = ray::shades_in_vectors(shot_.scene);
    if (in_vectors) add_groups();
    for (int i = 0; i < rays_.count; ++i) {
      if (!hits_.hit(i)) {
        add_miss(i);
      } else if (!in_vectors) {
        add_point(i);
      }
    }
  }

  /// Instance by instance.
  void add_groups() {
    const ray::HitGroups groups(hits_, static_cast<std::size_t>(rays_.count));
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const std::span<const std::uint16_t> rays = groups.rays(g);
      group_.collect(rays_, hits_, rays);
      for (std::size_t k = 0; k < rays.size(); ++k) group_.sample_area.at[k] = sample_area(rays[k]);
      group_.shade(shot_.scene, shot_.config);
      for (std::size_t k = 0; k < rays.size(); ++k) {
        name_point(rays[k], tile_.points.count + k);
        write_hit(rays[k], group_.emission(k, shot_.scene), group_.reflectors.shading[k],
                  group_.bsdfs.base[k]);
      }
      tile_.points.append(group_);
    }
  }
  void name_point(int i, std::size_t point) {
    const auto cell = cells_[static_cast<std::size_t>(i)];
    tile_.cell_of[point] = cell;
    tile_.point_of[cell] = static_cast<std::uint16_t>(point);
    tile_.points.keys[point] = keys_[static_cast<std::size_t>(i)];
  }

  image::Pixel pixel(int i) const {
    const int cell = cells_[static_cast<std::size_t>(i)];
    return {tile_.rect.x + cell % ray::kTileSide, tile_.rect.y + cell / ray::kTileSide};
  }

  void add_point(int i) {
    const DVec3 seen = shot_.view.world_from_view.position + DVec3(hits_.t[i] * rays_.direction(i));
    const shading::Surface surface = shot_.scene.surface(hits_.at(i), seen);
    const ray::ShadingRequest request{surface, -glm::normalize(rays_.direction(i)), uv_per_meter(i),
                                      footprint_m(i)};
    const ray::ShadedPoint shaded = ray::shade_point(request, shot_.scene, shot_.config);
    name_point(i, tile_.points.count);
    tile_.points.push(surface, shaded.reflector, keys_[static_cast<std::size_t>(i)]);
    write_hit(i, shaded.emission, shaded.reflector.frame().shading,
              shot_.scene.materials().base_color(surface, request.footprint()));
  }
  float uv_per_meter(int i) const {
    if (shot_.config.mode == Mode::Exact) return 0.0F;
    return shot_.scene.uv_per_meter(hits_.instance[i], hits_.triangle[i]);
  }
  /// As kernel `ray`'s: a tangent area A at depth z covers the solid angle A cos^3 and, at distance
  /// z / cos, the area A z^2 cos.
  float footprint_m(int i) const {
    return hits_.t[i] * std::sqrt(sample_area(i) / glm::length(rays_.direction(i)));
  }
  /// On the tangent plane; 0: textures unfiltered.
  float sample_area(int i) const {
    if (shot_.config.mode == Mode::Exact) return 0.0F;
    const image::Pixel at = pixel(i);
    const Vec2 cell = shot_.view.grid.footprint(at.x, at.y);
    return cell.x * cell.y;
  }

  void write_hit(int i, const Rgb& emission, const Vec3& normal, const Rgb& base_color) {
    const image::Pixel at = pixel(i);
    out_.radiance(at.x, at.y) = emission;
    out_.depth_m(at.x, at.y) = central_depth(i);
    if (shot_.wanted & kSurfaceId) out_.surface_id(at.x, at.y) = hits_.instance[i] + 1;
    if (shot_.wanted & kNormal) out_.normal(at.x, at.y) = normal;
    if (shot_.wanted & kAlbedo) out_.albedo(at.x, at.y) = base_color;
  }
  /// Where the hit's plane meets the ray through the cell's centre, unless too edge-on to be
  /// followed there (as kernel `ray`).
  float central_depth(int i) const {
    const float t = hits_.t[i];
    if (shot_.pattern.guide_is_central()) return t;
    const image::Pixel at = pixel(i);
    const Vec3 normal = hits_.normal(i);
    const Vec3 central = shot_.world_from_view * shot_.view.grid.ray(at.x, at.y);
    const float ratio = glm::dot(normal, rays_.direction(i)) / glm::dot(normal, central);
    return ratio > 0.5F && ratio < 2.0F ? t * ratio : t;
  }
  void add_miss(int i) {
    const image::Pixel at = pixel(i);
    out_.radiance(at.x, at.y) = shot_.scene.beyond(glm::normalize(rays_.direction(i)));
    out_.depth_m(at.x, at.y) = kInfinity;
    if (shot_.wanted & kSurfaceId) out_.surface_id(at.x, at.y) = 0;
    if (shot_.wanted & kNormal) out_.normal(at.x, at.y) = Vec3{0.0F};
    if (shot_.wanted & kAlbedo) out_.albedo(at.x, at.y) = Rgb{0.0F};
  }

  const Shot& shot_;
  SurfaceTile& tile_;
  ViewBuffers& out_;
  visibility::RayStream rays_;
  visibility::HitStream hits_;
  ray::SurfaceGroup group_;  ///< whole vectors are filled before they are read
  std::array<std::uint16_t, sampling::kBatch> cells_;
  std::array<sampling::SampleKey, sampling::kBatch> keys_;
};

/// All views are one pass: ranks meet once, and the last tiles of one view run beside the first of
/// the next.
struct TileOfView {
  std::size_t view;
  SurfaceTile* tile;
};
std::vector<scheduling::TilePlace> places_of(const std::vector<ViewSurfaces>& surfaces) {
  std::vector<scheduling::TilePlace> all;
  for (std::size_t v = 0; v < surfaces.size(); ++v) {
    const auto places = surfaces[v].places(v);
    all.insert(all.end(), places.begin(), places.end());
  }
  return all;
}

void lay_out(const PixelGrid& grid, ViewSurfaces& view) {
  constexpr int kSide = ray::kTileSide;
  view.width = grid.width(), view.height = grid.height();
  view.columns = (view.width + kSide - 1) / kSide;
  const int rows = (view.height + kSide - 1) / kSide;
  view.tiles.resize(static_cast<std::size_t>(view.columns * rows));
  for (std::size_t k = 0; k < view.tiles.size(); ++k) {
    const int x = static_cast<int>(k) % view.columns * kSide;
    const int y = static_cast<int>(k) / view.columns * kSide;
    view.tiles[k].rect = {x, y, std::min(kSide, view.width - x), std::min(kSide, view.height - y)};
  }
}

}  // namespace

std::vector<scheduling::TilePlace> ViewSurfaces::places(std::size_t index) const {
  std::vector<scheduling::TilePlace> places;
  for (const SurfaceTile& tile : tiles)
    places.push_back(scheduling::place_of(tile.rect, width, height, index));
  return places;
}

void append(const SurfaceTile& from, std::size_t point, SurfaceTile& to) {
  const ray::LitPoints& old = from.points;
  ray::LitPoints& points = to.points;
  const std::size_t i = points.count++;
  points.position.set(i, old.position[point]);
  points.ray_origin.set(i, old.ray_origin[point]);
  points.reflectors.take(i, old.reflectors, point);
  points.keys[i] = old.keys[point];
  if (points.keeps_whole) points.whole.push_back(old.whole[point]);
  to.cell_of[i] = from.cell_of[point];
}

void give_keys(const PixelGrid& grid, std::uint64_t seed, std::uint64_t frame, SurfaceTile& tile) {
  for (std::size_t i = 0; i < tile.points.count; ++i) {
    const image::Pixel at = tile.pixel(i);
    tile.points.keys[i] = {seed, frame, grid.cell_key(at.x, at.y)};
  }
}

void give_keys(const PixelGrid& grid, std::uint64_t seed, std::uint64_t frame, ViewSurfaces& view) {
  for (SurfaceTile& tile : view.tiles) give_keys(grid, seed, frame, tile);
}

FrameReport trace_surfaces(const FrameRequest& request, const SceneFrame& scene,
                           const ray::Config& config, TileScheduler& scheduler,
                           std::vector<ViewSurfaces>& surfaces, FrameBuffers& out) {
  surfaces.resize(request.views.size());
  std::vector<Shot> shots;
  std::vector<TileOfView> tiles;
  for (std::size_t v = 0; v < surfaces.size(); ++v) {
    lay_out(request.views[v].grid, surfaces[v]);
    shots.emplace_back(request, request.views[v], scene, config, out.wanted);
    for (SurfaceTile& tile : surfaces[v].tiles) tiles.push_back({v, &tile});
  }
  std::vector<FrameReport> parts(tiles.size());
  const auto outcome = scheduling::run_shared(
      scheduler, tiles.size(), Audience::EveryRank, [&] { return places_of(surfaces); },
      [&](std::size_t k) {
        const auto& [v, tile] = tiles[k];
        parts[k] = TileShot(shots[v], *tile, out.views[v]).run();
      },
      [&](std::size_t k, Parcel& parcel) {
        const auto& [v, tile] = tiles[k];
        kernels::carry(parts[k], parcel);
        carry(*tile, {request, request.views[v].grid, out.views[v]}, parcel);
      });
  FrameReport report;
  for (const FrameReport& part : parts) report += part;
  report.stopped = outcome == scheduling::Outcome::Stopped;
  return report;
}

}  // namespace macula::kernels::lightcuts
