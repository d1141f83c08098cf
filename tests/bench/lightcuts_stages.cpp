#include "tests/bench/lightcuts_stages.h"

#include <cmath>
#include <memory>

#include "server/kernels/lightcuts/gloss.h"
#include "server/kernels/lightcuts/node_choices.h"
#include "server/kernels/planes.h"
#include "server/lights/placed_lights.h"
#include "tests/bench/stopwatch.h"

namespace macula::bench {
namespace {

using kernels::lightcuts::SurfaceTile;
using kernels::lightcuts::ViewSurfaces;

double tree_ms(const kernels::SceneFrame& scene) {
  constexpr int kTimes = 8;
  lights::PlacedLights placed(scene.lights());  // the first one makes room
  if (placed.size() != scene.placed_lights().size()) return std::nan("");
  Stopwatch watch;
  for (int k = 0; k < kTimes; ++k) placed.make(scene.lights());
  return watch.lap().cpu_ms / kTimes;
}

/// Cuts and walks of one tile after the other.
class Walker {
 public:
  explicit Walker(const lights::LightTree& tree) : tree_(tree) {}

  void add(const SurfaceTile& tile, const Plane<std::uint16_t>& cut_nodes,
           LightcutsStages& stages) {
    descents_.clear();
    watch_.lap();
    for (std::size_t i = 0; i < tile.points.count; ++i) cut(tile, i, cut_nodes);
    stages.cut_ms += watch_.lap().cpu_ms;
    choices_.resize(descents_.size());
    lights::choose_each(tree_, lights::WeightRule::NearAndFar, descents_, choices_);
    stages.sample_ms += watch_.lap().cpu_ms;
  }

 private:
  void cut(const SurfaceTile& tile, std::size_t i, const Plane<std::uint16_t>& cut_nodes) {
    const image::Pixel at = tile.pixel(i);
    const lights::Receiver receiver = kernels::lightcuts::receiver_of(tile.points, i);
    lights::LightWalk(tree_, receiver).cut(cut_nodes(at.x, at.y), cut_);
    for (std::uint32_t round = 0; round < cut_.nodes.size(); ++round)
      descents_.push_back({receiver, cut_.nodes[round],
                           lights::leaf_number(tile.points.keys[i], round, tile.points.sample)});
  }

  const lights::LightTree& tree_;
  Stopwatch watch_;
  lights::LightCut cut_;
  std::vector<lights::Descent> descents_;
  std::vector<lights::LeafChoice> choices_;
};

std::size_t points_in(const std::vector<SurfaceTile>& tiles) {
  std::size_t points = 0;
  for (const SurfaceTile& tile : tiles) points += tile.points.count;
  return points;
}

/// One tile in `every`, and the share of all points that they hold.
struct ChosenTiles {
  std::vector<SurfaceTile> tiles;
  double share = 1.0;
};
ChosenTiles chosen(std::vector<SurfaceTile> all, int every) {
  const std::size_t points = points_in(all);
  ChosenTiles some;
  for (std::size_t k = 0; k < all.size(); k += static_cast<std::size_t>(every))
    some.tiles.push_back(std::move(all[k]));
  if (points > 0)
    some.share = static_cast<double>(points_in(some.tiles)) / static_cast<double>(points);
  return some;
}

/// With gloss: its rays.
double glossy_ms(const kernels::SceneFrame& scene, const kernels::lightcuts::Config& config,
                 const std::vector<SurfaceTile>& tiles, const Plane<std::uint16_t>& cut_nodes) {
  if (!kernels::lightcuts::has_gloss(scene, config.ray)) return 0.0;
  Stopwatch watch;
  for (const SurfaceTile& tile : tiles) {
    std::vector<Rgb> slots(tile.points.count, Rgb{0.0F});
    kernels::ray::LightingWork work;
    kernels::lightcuts::add_gloss(scene, config, tile, {cut_nodes}, work, slots);
  }
  return watch.lap().cpu_ms;
}

/// Asks nobody: which light it would be is not looked at.
struct Uncounted {
  void operator()(const kernels::lightcuts::CutNode&, const lights::LeafChoice&) const {}
};

/// The share of every point's nodes that is taken, a point as a tile of its own.
Plane<float> taken_shares(const kernels::SceneFrame& scene, const ViewSurfaces& surfaces,
                          const kernels::lightcuts::CutPlan& plan) {
  Plane<float> shares(surfaces.width, surfaces.height);
  const auto single = std::make_unique<SurfaceTile>();
  for (const SurfaceTile& tile : surfaces.tiles) {
    single->rect = tile.rect;
    single->points.sample = tile.points.sample;
    for (std::size_t i = 0; i < tile.points.count; ++i) {
      single->points.count = 0;
      kernels::lightcuts::append(tile, i, *single);
      kernels::lightcuts::CutWork work;
      Uncounted sink;
      kernels::lightcuts::NodeChoices<Uncounted>(scene, *single, plan, work, sink).run();
      const auto all = static_cast<float>(work.taken + work.walked);
      const image::Pixel at = tile.pixel(i);
      shares(at.x, at.y) = all > 0.0F ? static_cast<float>(work.taken) / all : 0.0F;
    }
  }
  return shares;
}

}  // namespace

LightcutsStages stages_of(const LightcutsSetting& setting, const kernels::lightcuts::Config& config,
                          const Plane<std::uint16_t>& cut_nodes, int every,
                          scheduling::TileScheduler& scheduler) {
  LightcutsStages stages;
  stages.tree_ms = tree_ms(*setting.scene);
  const FoveationMap map = setting.map();
  kernels::FrameBuffers out;
  kernels::prepare_buffers({&setting.view, 1}, out);
  std::vector<ViewSurfaces> surfaces;
  kernels::lightcuts::trace_surfaces({{&setting.view, 1}, map, 0, 1}, *setting.scene, config.ray,
                                     scheduler, surfaces, out);
  Walker walker(setting.scene->placed_lights().tree());
  const auto [tiles, share] = chosen(std::move(surfaces.front().tiles), every);
  for (const SurfaceTile& tile : tiles) walker.add(tile, cut_nodes, stages);
  if (setting.gloss == kernels::lightcuts::Gloss::Yes)
    stages.glossy_ms = glossy_ms(*setting.scene, config, tiles, cut_nodes);
  stages.cut_ms /= share, stages.sample_ms /= share, stages.glossy_ms /= share;
  return stages;
}

LightcutsStagePlanes stage_planes_of(const LightcutsSetting& setting,
                                     const kernels::lightcuts::Config& config,
                                     scheduling::TileScheduler& scheduler) {
  const FoveationMap map = setting.map();
  const kernels::FrameRequest request{{&setting.view, 1}, map, 0, 1};
  kernels::FrameBuffers out;
  out.wanted = kernels::kNormal | kernels::kAlbedo;
  kernels::prepare_buffers({&setting.view, 1}, out);
  std::vector<ViewSurfaces> surfaces;
  kernels::lightcuts::trace_surfaces(request, *setting.scene, config.ray, scheduler, surfaces, out);
  auto low = kernels::lightcuts::trace_low_views(request, *setting.scene, config, scheduler);
  auto plan =
      kernels::lightcuts::plan_lights(request, *setting.scene, config, out, {}, low, scheduler);
  kernels::lightcuts::LowPicture drawn;
  drawn.factor = config.low_resolution;
  kernels::lightcuts::give_keys(low.views.front().grid, request.seed + 1, 0, low.surfaces.front());
  kernels::lightcuts::draw_low_picture(*setting.scene, low.surfaces.front(), 0, config.kept_nodes,
                                       scheduler, drawn);
  LightcutsStagePlanes planes;
  planes.taken = taken_shares(
      *setting.scene, surfaces.front(),
      {plan.cut_nodes.front(), config.most_nodes, &plan.maps.front().map, &drawn, setting.gloss});
  planes.low_picture = std::move(low.out.views.front().radiance);
  planes.maps = std::move(plan.maps.front());
  planes.cut_nodes = std::move(plan.cut_nodes.front());
  return planes;
}

}  // namespace macula::bench
