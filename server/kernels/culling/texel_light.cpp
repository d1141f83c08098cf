#include "server/kernels/culling/texel_light.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "server/kernels/culling/same_surface.h"
#include "server/kernels/parcels.h"
#include "server/kernels/planes.h"
#include "server/kernels/ray/tile.h"

namespace macula::kernels::culling {
namespace {

constexpr std::uint64_t kTurnKey = 0xC0117'0004ULL;  ///< classes of a frame turn all alike

/// Cells that texels ask, each once, those of near texels together; and their classes of lights.
struct Asked {
  std::vector<Pixel> cells;
  Plane<std::uint16_t> light_class;
};

Asked cells_asked(const TexelMap& map, const PixelGrid& grid, int classes,
                  const FrameRequest& request) {
  const auto turn =
      static_cast<int>(sampling::sample_bits({request.seed, request.frame, kTurnKey}, 0, 0) %
                       static_cast<std::uint32_t>(classes));
  const int side = static_cast<int>(std::lround(std::sqrt(classes)));
  Asked asked{{}, Plane<std::uint16_t>(grid.width(), grid.height())};
  const auto class_at = [&](int u, int v) {
    return static_cast<std::uint16_t>((u % side + side * (v % side) + turn) % classes);
  };
  for (int y = 0; y < grid.height(); ++y)
    for (int x = 0; x < grid.width(); ++x) asked.light_class(x, y) = class_at(x, y);
  Plane<std::uint8_t> known(grid.width(), grid.height(), 0);
  constexpr int kTile = ray::kTileSide;
  for (int top = 0; top < map.height(); top += kTile) {
    for (int left = 0; left < map.width(); left += kTile) {
      for (int v = top; v < std::min(top + kTile, map.height()); ++v) {
        for (int u = left; u < std::min(left + kTile, map.width()); ++u) {
          const Pixel cell = map.cell(u, v);
          if (known(cell.x, cell.y) != 0) continue;
          known(cell.x, cell.y) = 1;
          asked.cells.push_back(cell);
          asked.light_class(cell.x, cell.y) = class_at(u, v);
        }
      }
    }
  }
  return asked;
}

class TexelSharing {
 public:
  TexelSharing(const TexelMap& map, const SameSurface& same, const Plane<Rgb>& by_cell, int reach)
      : map_(map), same_(same), by_cell_(by_cell), reach_(reach) {}

  /// Those at the rim count half: a square of 2 reach x 2 reach.
  Rgb at(int u, int v) const {
    const Pixel here = map_.cell(u, v);
    Rgb sum = by_cell_(here.x, here.y);
    float weights = 1.0F;
    for (int dv = -reach_; dv <= reach_; ++dv) {
      for (int du = -reach_; du <= reach_; ++du) {
        if (du == 0 && dv == 0) continue;
        const Pixel there = neighbour(u + du, v + dv);
        if (there.x < 0 || !same_(here, there)) continue;
        const float weight = rim(du) * rim(dv);
        sum += weight * by_cell_(there.x, there.y);
        weights += weight;
      }
    }
    return sum / weights;
  }

 private:
  float rim(int d) const { return std::abs(d) == reach_ ? 0.5F : 1.0F; }
  /// x < 0: none.
  Pixel neighbour(int u, int v) const {
    if (map_.wraps()) v = (v + map_.height()) % map_.height();
    const bool inside = u >= 0 && u < map_.width() && v >= 0 && v < map_.height();
    return inside ? map_.cell(u, v) : Pixel{-1, -1};
  }

  const TexelMap& map_;
  const SameSurface& same_;
  const Plane<Rgb>& by_cell_;
  int reach_;
};

/// From texels back to cells.
class TexelMix {
 public:
  TexelMix(const TexelMap& map, const SameSurface& same, const Plane<Rgb>& texels)
      : map_(map), same_(same), texels_(texels) {}

  /// nullopt: no texel around the cell lies on its surface.
  std::optional<Rgb> at(int x, int y) const {
    const Vec2 place = map_.place(x, y) - 0.5F;
    const Vec2 corner = glm::floor(place), t = place - corner;
    const int left = static_cast<int>(corner.x), top = static_cast<int>(corner.y);
    Rgb sum{0.0F};
    float weights = 0.0F;
    for (int k = 0; k < 4; ++k) {
      const int dx = k % 2, dy = k / 2;
      const Pixel texel = held(left + dx, top + dy);
      if (!same_({x, y}, map_.cell(texel.x, texel.y))) continue;
      const float weight = (dx == 0 ? 1.0F - t.x : t.x) * (dy == 0 ? 1.0F - t.y : t.y);
      sum += weight * texels_(texel.x, texel.y);
      weights += weight;
    }
    return weights > 0.0F ? std::optional(sum / weights) : std::nullopt;
  }

 private:
  Pixel held(int u, int v) const {
    v = map_.wraps() ? (v + map_.height()) % map_.height() : std::clamp(v, 0, map_.height() - 1);
    return {std::clamp(u, 0, map_.width() - 1), v};
  }

  const TexelMap& map_;
  const SameSurface& same_;
  const Plane<Rgb>& texels_;
};

FrameReport render_asked(const ray::ViewContext& context, std::size_t view,
                         std::span<const Pixel> cells, TileScheduler& scheduler, ViewBuffers& out) {
  constexpr std::size_t kStep = visibility::kStreamCapacity;
  std::vector<FrameReport> parts((cells.size() + kStep - 1) / kStep);
  const auto cells_of = [&](std::size_t part) {
    return cells.subspan(part * kStep, std::min(kStep, cells.size() - part * kStep));
  };
  const auto outcome = scheduling::run_shared(
      scheduler, parts.size(), Audience::EveryRank,
      by_batches(cells, kStep, context.view.grid, view),
      [&](std::size_t part) { parts[part] = ray::render_cells(context, cells_of(part), out); },
      [&](std::size_t part, Parcel& parcel) {
        carry(parts[part], parcel);
        parcel.cells(out.light, cells_of(part));
      });
  FrameReport report;
  for (const FrameReport& part : parts) report += part;
  report.stopped = outcome == scheduling::Outcome::Stopped;
  return report;
}

}  // namespace

FrameReport add_texel_light(const FrameRequest& request, std::size_t view, const TexelMap& map,
                            const SceneFrame& scene, const ray::Config& config, int reach,
                            const ViewBuffers& surfaces, TileScheduler& scheduler,
                            Plane<Rgb>& light) {
  const View& shown = request.views[view];
  ray::Config virtual_only = config;
  virtual_only.lights = ray::LightChoice::None;
  FrameBuffers out;
  out.wanted = kLight;
  prepare_buffers({&shown, 1}, out);
  const Asked asked =
      cells_asked(map, shown.grid, config.virtual_lights.lights->classes(), request);
  ray::ViewContext context(shown, scene, virtual_only, request, out.wanted);
  context.light_class = &asked.light_class;
  FrameReport report = render_asked(context, view, asked.cells, scheduler, out.views.front());
  if (report.stopped) return report;
  const SameSurface same(shown, surfaces);
  Plane<Rgb> texels(map.width(), map.height());
  const TexelSharing sharing(map, same, out.views.front().light, reach);
  const auto texel_rows = static_cast<std::size_t>(map.height());
  scheduling::run_shared(
      scheduler, texel_rows, Audience::EveryRank, scheduling::by_rows(texel_rows, view),
      [&](std::size_t row) {
        const int v = static_cast<int>(row);
        for (int u = 0; u < map.width(); ++u) texels(u, v) = sharing.at(u, v);
      },
      [&](std::size_t row, Parcel& parcel) { parcel.values(texels.row(static_cast<int>(row))); });
  const TexelMix mix(map, same, texels);
  std::vector<std::vector<Pixel>> alone(static_cast<std::size_t>(light.height()));
  const auto mix_row = [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < light.width(); ++x) {
      if (!std::isfinite(surfaces.depth_m(x, y))) continue;
      const auto mixed = mix.at(x, y);
      if (mixed) light(x, y) += *mixed;
      if (!mixed) alone[row].push_back({x, y});
    }
  };
  scheduling::run_shared(scheduler, alone.size(), Audience::EveryRank,
                         scheduling::by_rows(alone.size(), view), mix_row,
                         [&](std::size_t row, Parcel& parcel) {
                           parcel.values(light.row(static_cast<int>(row)));
                           parcel.vector(alone[row]);
                         });
  std::vector<Pixel> cells;
  for (const auto& row : alone) cells.insert(cells.end(), row.begin(), row.end());
  report += render_asked(context, view, cells, scheduler, out.views.front());
  for (const Pixel& cell : cells) light(cell.x, cell.y) += out.views.front().light(cell.x, cell.y);
  return report;
}

}  // namespace macula::kernels::culling
