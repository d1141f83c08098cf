#include "server/kernels/lightcuts/cut_light.h"

#include <algorithm>
#include <cmath>

#include "server/kernels/lightcuts/node_choices.h"

namespace macula::kernels::lightcuts {
namespace {

using lights::Descent;
using lights::LeafChoice;
using lights::NodeId;
using lights::Receiver;
using lights::WeightRule;

/// Asks lights for nodes in the order they come, batch after batch.
class Asker {
 public:
  Asker(const SceneFrame& scene, const SurfaceTile& tile, const CutPlan& plan,
        ray::LightingWork& work, std::span<Rgb> slots)
      : scene_(scene),
        tile_(tile),
        rounds_(static_cast<std::uint32_t>(plan.most_nodes)),
        questions_(scene, plan.gloss, plan.lamp_area_m2),
        rays_(scene, work),
        slots_(slots) {}

  void operator()(const CutNode& node, const LeafChoice& choice) {
    if (choice.leaf == 0) return;
    asked_[questions_.size()] = node;
    questions_.push(tile_.points, node.point,
                    {*scene_.placed_lights().tree().light_at(choice.leaf),
                     static_cast<float>(1.0 / choice.probability),
                     place_on_light(tile_.points, node.point, node.round, rounds_)});
    if (questions_.full()) send();
  }
  void finish() {
    send();
    rays_.flush(slots_);
  }

 private:
  void send() {
    const std::size_t n = questions_.size();
    questions_.answer(answers_);
    for (std::size_t k = 0; k < n; ++k) {
      const CutNode& node = asked_[k];
      const Vec3 origin = tile_.points.ray_origin[node.point];
      rays_.push({origin, answers_[k].end - origin, 1.0F,
                  blend_of(scene_, tile_.points, node.point, Term::Area, node.round)},
                 {answers_[k].reflected, node.point}, slots_);
    }
  }

  const SceneFrame& scene_;
  const SurfaceTile& tile_;
  std::uint32_t rounds_;
  LightQuestions questions_;
  ShadowRays rays_;
  std::span<Rgb> slots_;
  std::array<CutNode, sampling::kBatch> asked_;
  std::array<Answer, sampling::kBatch> answers_;
};

/// The samples of one tile of the low-resolution picture.
class LowTile {
 public:
  LowTile(const SceneFrame& scene, const SurfaceTile& tile, int nodes)
      : scene_(scene),
        tree_(scene.placed_lights().tree()),
        tile_(tile),
        nodes_(static_cast<std::size_t>(nodes)),
        questions_(scene),
        rays_(scene, work_) {}

  ray::LightingWork run(LowPicture& picture) {
    for (std::size_t i = 0; i < tile_.points.count; ++i) draw(i);
    arrived_.resize(samples_.size());
    send();
    rays_.flush(arrived_);
    keep(picture);
    return work_;
  }

 private:
  void draw(std::size_t i) {
    const Receiver receiver = receiver_of(tile_.points, i);
    lights::LightWalk(tree_, receiver).cut(nodes_, cut_);
    cut_.nodes.insert(cut_.nodes.end(), cut_.dark.begin(), cut_.dark.end());
    for (std::uint32_t r = 0; r < cut_.nodes.size(); ++r) {
      descents_.push_back({receiver, cut_.nodes[r],
                           lights::leaf_number(tile_.points.keys[i], r, tile_.points.sample)});
    }
    choices_.resize(descents_.size());
    lights::choose_each(tree_, WeightRule::Defensive, descents_, choices_);
    for (std::size_t r = 0; r < descents_.size(); ++r) {
      samples_.push_back(
          {descents_[r].node, choices_[r].leaf, choices_[r].probability, 0.0F, 0.0F});
      owners_.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(r)});
    }
    descents_.clear();
  }

  void send() {
    const auto rounds = static_cast<std::uint32_t>(nodes_);
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      if (samples_[k].leaf == 0) continue;
      asked_[questions_.size()] = k;
      questions_.push(
          tile_.points, owners_[k].point,
          {*tree_.light_at(samples_[k].leaf), static_cast<float>(1.0 / samples_[k].probability),
           place_on_light(tile_.points, owners_[k].point, owners_[k].round, rounds)});
      if (questions_.full()) receive();
    }
    receive();
  }
  void receive() {
    const std::size_t n = questions_.size();
    questions_.answer(answers_);
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t k = asked_[j];
      const CutNode& owner = owners_[k];
      samples_[k].open = image::luminance(answers_[j].reflected);
      const Vec3 origin = tile_.points.ray_origin[owner.point];
      rays_.push({origin, answers_[j].end - origin, 1.0F,
                  blend_of(scene_, tile_.points, owner.point, Term::Area, owner.round)},
                 {answers_[j].reflected, static_cast<std::uint32_t>(k)}, arrived_);
    }
  }

  void keep(LowPicture& picture) {
    std::size_t k = 0;
    for (std::size_t i = 0; i < tile_.points.count; ++i) {
      std::vector<LowSample> mine;
      for (; k < samples_.size() && owners_[k].point == i; ++k) {
        samples_[k].brought = image::luminance(arrived_[k]);
        mine.push_back(samples_[k]);
      }
      const image::Pixel at = tile_.pixel(i);
      picture.pixels[static_cast<std::size_t>(at.y * picture.width + at.x)] =
          LowSamples(receiver_of(tile_.points, i), std::move(mine));
    }
  }

  const SceneFrame& scene_;
  const lights::LightTree& tree_;
  const SurfaceTile& tile_;
  std::size_t nodes_;
  ray::LightingWork work_;
  LightQuestions questions_;
  ShadowRays rays_;
  lights::LightCut cut_;
  std::vector<Descent> descents_;
  std::vector<LeafChoice> choices_;
  std::vector<LowSample> samples_;
  std::vector<CutNode> owners_;
  std::vector<Rgb> arrived_;
  std::array<std::size_t, sampling::kBatch> asked_;
  std::array<Answer, sampling::kBatch> answers_;
};

}  // namespace

void add_cut_light(const SceneFrame& scene, const SurfaceTile& tile, const CutPlan& plan,
                   CutWork& work, std::span<Rgb> slots) {
  if (scene.placed_lights().size() == 0) return;
  Asker asker(scene, tile, plan, work.lighting, slots);
  NodeChoices<Asker>(scene, tile, plan, work, asker).run();
  asker.finish();
}

FrameReport draw_low_picture(const SceneFrame& scene, const ViewSurfaces& surfaces,
                             std::size_t view, int nodes, TileScheduler& scheduler,
                             LowPicture& picture) {
  picture.width = surfaces.width, picture.height = surfaces.height;
  const auto count = static_cast<std::size_t>(surfaces.width * surfaces.height);
  picture.pixels.assign(count, LowSamples({}, {}));
  picture.hit.assign(count, false);
  for (const SurfaceTile& tile : surfaces.tiles) {
    for (std::size_t i = 0; i < tile.points.count; ++i) {
      const image::Pixel at = tile.pixel(i);
      picture.hit[static_cast<std::size_t>(at.y * surfaces.width + at.x)] = true;
    }
  }
  std::vector<ray::LightingWork> parts(surfaces.tiles.size());
  const auto outcome = scheduling::run_shared(
      scheduler, parts.size(), Audience::EveryRank, [&] { return surfaces.places(view); },
      [&](std::size_t k) { parts[k] = LowTile(scene, surfaces.tiles[k], nodes).run(picture); },
      [&](std::size_t k, Parcel& parcel) {
        parcel.value(parts[k]);
        for (std::size_t i = 0; i < surfaces.tiles[k].points.count; ++i) {
          const image::Pixel at = surfaces.tiles[k].pixel(i);
          picture.pixels[static_cast<std::size_t>(at.y * surfaces.width + at.x)].carry(parcel);
        }
      });
  FrameReport report;
  for (const ray::LightingWork& part : parts) {
    report.shadow_rays += part.shadow_rays, report.trace_ms += part.trace_ms;
  }
  report.stopped = outcome == scheduling::Outcome::Stopped;
  return report;
}

}  // namespace macula::kernels::lightcuts
