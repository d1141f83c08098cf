#include "server/kernels/lightcuts/reservoir_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/kernels/lightcuts/node_choices.h"
#include "shared/foveation/eccentricity.h"

namespace macula::kernels::lightcuts {
namespace {

constexpr std::uint32_t kChooseDimension = 0xF000'0000U;  ///< of a cell's random numbers
constexpr std::uint32_t kNeighbourDimension = 0xF000'0010U;
constexpr std::uint32_t kKeepDimension = 0xF000'0020U;
/// Frames of memory that need no second neighbour's: its lights are less like one's own.
constexpr float kEnough = 4.0F;
/// Shadow rays of neighbours' lights, after those of the own cut's.
constexpr std::uint32_t kNeighbourRound = 0x1000U;

struct Drawn {
  std::uint32_t point = 0;
  Ask ask;
  Answer answer;
};
/// A light that gets a ray.
struct Chosen {
  std::uint32_t point = 0, round = 0;
  Ask ask;              ///< inverse_probability: of all draws and the choice together
  Rgb reflected{0.0F};  ///< already over that
  float shares = 1.0F;  ///< sum of own shares, by pairwise MIS
};
/// A reservoir of the last frame asked here.
struct Recalled {
  std::uint32_t point = 0, round = 0;
  SurfaceAt there;
  Reservoir reservoir;
  Rgb reflected{0.0F};  ///< here, unit weight
  float target_there = 0.0F;
};

class TileReservoirs {
 public:
  TileReservoirs(const SceneFrame& scene, const SurfaceTile& tile, const CutPlan& plan,
                 const ReservoirConfig& config, const KeptView* last, const View& view,
                 CutWork& work)
      : scene_(scene),
        tile_(tile),
        plan_(plan),
        config_(config),
        last_(last),
        view_(view),
        work_(work),
        questions_(scene, plan.gloss, plan.lamp_area_m2),
        rays_(scene, work.lighting) {}

  void run(Plane<Reservoir>& reservoirs, std::span<Rgb> slots) {
    draw();
    choose();
    recall();
    compare();
    trace();
    combine(reservoirs, slots);
  }

 private:
  // ---- own draws ----

  struct Collector {
    TileReservoirs& owner;
    void operator()(const CutNode& node, const lights::LeafChoice& choice) const {
      if (choice.leaf == 0) return;
      const auto rounds = static_cast<std::uint32_t>(owner.plan_.most_nodes);
      owner.drawn_.push_back({node.point,
                              {*owner.scene_.placed_lights().tree().light_at(choice.leaf),
                               static_cast<float>(1.0 / choice.probability),
                               place_on_light(owner.tile_.points, node.point, node.round, rounds)},
                              {}});
    }
  };
  void draw() {
    Collector collector{*this};
    NodeChoices<Collector>(scene_, tile_, plan_, work_, collector).run();
    std::ranges::stable_sort(drawn_, {}, &Drawn::point);
    ask(
        drawn_.size(),
        [&](std::size_t k) {
          return Question{&tile_.points, drawn_[k].point, drawn_[k].ask};
        },
        [&](std::size_t k, const Answer& answer) { drawn_[k].answer = answer; });
  }

  struct Question {
    const ray::LitPoints* points;
    std::size_t point;
    Ask ask;
  };
  template <class QuestionOf, class Receive>
  void ask(std::size_t count, const QuestionOf& question_of, const Receive& receive) {
    for (std::size_t first = 0; first < count; first += sampling::kBatch) {
      const std::size_t last = std::min(first + sampling::kBatch, count);
      for (std::size_t k = first; k < last; ++k) {
        const Question question = question_of(k);
        questions_.push(*question.points, question.point, question.ask);
      }
      questions_.answer(answers_);
      for (std::size_t k = first; k < last; ++k) receive(k, answers_[k - first]);
    }
  }

  /// RIS: a few of each point's draws by what they would bring, systematically.
  void choose() {
    std::size_t first = 0;
    for (std::uint32_t point = 0; point < tile_.points.count; ++point) {
      std::size_t last = first;
      while (last < drawn_.size() && drawn_[last].point == point) ++last;
      choose_of(point, first, last);
      first = last;
    }
  }
  void choose_of(std::uint32_t point, std::size_t first, std::size_t last) {
    double sum = 0.0;
    for (std::size_t k = first; k < last; ++k) sum += worth(drawn_[k].answer.reflected);
    if (!(sum > 0.0)) return;
    const auto nodes = static_cast<int>(last - first);
    const int rays = config_.rays.of(nodes);
    const double step = sum / rays;
    const auto u =
        static_cast<double>(sampling::sample(tile_.points.keys[point], kChooseDimension));
    double next = u * step, before = 0.0;
    for (std::size_t k = first; k < last; ++k) {
      const double mine = worth(drawn_[k].answer.reflected);
      int times = 0;
      for (; next < before + mine && times < rays; next += step) ++times;
      before += mine;
      if (times == 0) continue;
      const auto gain = static_cast<float>(times * step / mine);
      Chosen chosen{point, static_cast<std::uint32_t>(k - first), drawn_[k].ask,
                    gain * drawn_[k].answer.reflected, 1.0F};
      chosen.ask.inverse_probability *= gain;
      chosen_.push_back(chosen);
      ends_.push_back(drawn_[k].answer.end);
    }
  }
  static double worth(const Rgb& reflected) {
    return static_cast<double>(image::luminance(reflected));
  }

  // ---- what the last frame kept ----

  void recall() {
    pairs_.assign(tile_.points.count, 0);
    if (last_ == nullptr || last_->reservoirs.empty()) return;
    for (std::uint32_t point = 0; point < tile_.points.count; ++point) {
      const image::Pixel cell = tile_.pixel(point);
      if (!plan_.smoothed || plan_.nodes(cell.x, cell.y) >= kLargeCut) recall_at(point);
    }
    ask(
        recalled_.size(),
        [&](std::size_t k) {
          return Question{&tile_.points, recalled_[k].point, unit(recalled_[k].reservoir)};
        },
        [&](std::size_t k, const Answer& answer) {
          recalled_[k].reflected = answer.reflected;
          recalled_ends_.push_back(answer.end);
        });
    ask(
        recalled_.size(),
        [&](std::size_t k) {
          return Question{recalled_[k].there.points, recalled_[k].there.index,
                          unit(recalled_[k].reservoir)};
        },
        [&](std::size_t k, const Answer& answer) {
          recalled_[k].target_there = image::luminance(answer.reflected);
        });
  }
  static Ask unit(const Reservoir& reservoir) { return {reservoir.light, 1.0F, reservoir.u}; }

  void recall_at(std::uint32_t point) {
    const DVec3 here(tile_.points.position[point]);
    const Pose& world_from_view = last_->view.world_from_view;
    const Vec3 seen(glm::conjugate(world_from_view.rotation) * (here - world_from_view.position));
    const auto cell = last_->view.grid.project(seen);
    if (!cell) return;
    const int x = static_cast<int>(cell->x), y = static_cast<int>(cell->y);
    if (recall_from(point, x, y) >= kEnough) return;
    const image::Pixel pixel = tile_.pixel(point);
    // By cell and where it is needed: over all cells it would cost every rank as much as one alone.
    const auto e = static_cast<float>(
        foveation::eccentricity(view_.gaze.direction, view_.grid.ray(pixel.x, pixel.y)).value());
    constexpr float kFovea = 5.0F * std::numbers::pi_v<float> / 180.0F;
    if (e < kFovea) return;
    // Acuity falls about in proportion to 1 / (1 + e / 2.3 degrees): so far light may be blurred.
    const float radius = std::min(2.0F + 2.0F * e / kFovea, 16.0F);
    const Vec2 u = sampling::sample_2d(tile_.points.keys[point], kNeighbourDimension);
    const float r = radius * std::sqrt(u.x), phi = 2.0F * std::numbers::pi_v<float> * u.y;
    const int dx = static_cast<int>(std::lround(r * std::cos(phi)));
    const int dy = static_cast<int>(std::lround(r * std::sin(phi)));
    if (dx != 0 || dy != 0) recall_from(point, x + dx, y + dy);
  }
  /// How much is remembered there, frames.
  float recall_from(std::uint32_t point, int x, int y) {
    const ViewSurfaces& surfaces = last_->surfaces;
    if (x < 0 || y < 0 || x >= surfaces.width || y >= surfaces.height) return 0.0F;
    const SurfaceAt there = surfaces.at(x, y);
    const Reservoir& kept = last_->reservoirs(x, y);
    if (!there || !(kept.confidence > 0.0F)) return 0.0F;
    if (kept.light >= scene_.placed_lights().size() || !alike(point, there)) return 0.0F;
    const auto round = static_cast<std::uint32_t>(pairs_[point]++);
    recalled_.push_back({point, round, there, kept, {}, 0.0F});
    return kept.confidence;
  }
  /// Surfaces alone decide: normals within 25 degrees, planes apart by at most a tenth of what lies
  /// between, or by what one cell spans.
  bool alike(std::uint32_t point, const SurfaceAt& there) const {
    const Vec3 normal = tile_.points.reflectors.shading[point];
    if (glm::dot(normal, there.normal()) < 0.9F) return false;
    const Vec3 between = there.position() - tile_.points.position[point];
    const Vec3 geometric = tile_.points.reflectors.geometric[point];
    const float distance = glm::length(tile_.points.position[point] - last_eye());
    return std::abs(glm::dot(geometric, between)) <= 0.1F * glm::length(between) + 1e-3F * distance;
  }
  Vec3 last_eye() const { return Vec3(last_->view.world_from_view.position); }

  /// Own shares of what was chosen, against every neighbour.
  void compare() {
    struct Pair {
      std::size_t chosen, recalled;
    };
    std::vector<Pair> asked;
    std::size_t first = 0;
    for (std::size_t c = 0; c < chosen_.size(); ++c) {
      const std::uint32_t point = chosen_[c].point;
      if (pairs_[point] == 0) continue;
      chosen_[c].shares = 0.0F;
      while (first < recalled_.size() && recalled_[first].point < point) ++first;
      for (std::size_t r = first; r < recalled_.size() && recalled_[r].point == point; ++r) {
        asked.push_back({c, r});
      }
    }
    std::vector<float> targets(asked.size());
    std::vector<Vec3> ends(asked.size());
    ask(
        asked.size(),
        [&](std::size_t k) {
          const Ask& mine = chosen_[asked[k].chosen].ask;
          const SurfaceAt& there = recalled_[asked[k].recalled].there;
          return Question{there.points, there.index, {mine.light, 1.0F, mine.u}};
        },
        [&](std::size_t k, const Answer& answer) {
          targets[k] = image::luminance(answer.reflected);
          ends[k] = answer.end;
        });
    if (config_.traces_neighbours) {
      see_there(
          asked.size(), [&](std::size_t k) { return recalled_[asked[k].recalled].there; },
          [&](std::size_t k) {
            const Chosen& mine = chosen_[asked[k].chosen];
            const std::uint32_t pair = recalled_[asked[k].recalled].round;
            return CutNode{mine.point, (2U + pair) * kNeighbourRound + mine.round};
          },
          ends, targets);
    }
    for (std::size_t k = 0; k < asked.size(); ++k) {
      Chosen& mine = chosen_[asked[k].chosen];
      const Recalled& other = recalled_[asked[k].recalled];
      const float own = image::luminance(mine.reflected) / mine.ask.inverse_probability;
      mine.shares += own_share({own, other.reservoir.confidence * targets[k]}, pairs_[mine.point]);
    }
  }
  /// targets[k] becomes 0 where the light is hidden from the neighbour.
  template <class There, class RoundOf>
  void see_there(std::size_t count, const There& there_of, const RoundOf& round_of,
                 const std::vector<Vec3>& ends, std::vector<float>& targets) {
    std::vector<Rgb> arrived(count, Rgb{0.0F});
    for (std::size_t k = 0; k < count; ++k) {
      const SurfaceAt there = there_of(k);
      const Vec3 origin = there.points->ray_origin[there.index];
      const CutNode whose = round_of(k);
      rays_.push({origin, ends[k] - origin, 1.0F,
                  blend_of(scene_, tile_.points, whose.point, Term::Area, whose.round)},
                 {Rgb{targets[k]}, static_cast<std::uint32_t>(k)}, arrived);
    }
    rays_.flush(arrived);
    for (std::size_t k = 0; k < count; ++k) targets[k] = arrived[k].x;
  }

  // ---- rays, and the sum ----

  void trace() {
    arrived_.assign(chosen_.size() + recalled_.size(), Rgb{0.0F});
    const auto send = [&](std::uint32_t point, const Vec3& end, std::uint32_t round,
                          const Rgb& value, std::size_t slot) {
      const Vec3 origin = tile_.points.ray_origin[point];
      rays_.push(
          {origin, end - origin, 1.0F, blend_of(scene_, tile_.points, point, Term::Area, round)},
          {value, static_cast<std::uint32_t>(slot)}, arrived_);
    };
    for (std::size_t c = 0; c < chosen_.size(); ++c) {
      send(chosen_[c].point, ends_[c], chosen_[c].round, chosen_[c].reflected, c);
    }
    for (std::size_t r = 0; r < recalled_.size(); ++r) {
      if (!(recalled_[r].reservoir.weight > 0.0F)) continue;
      send(recalled_[r].point, recalled_ends_[r], kNeighbourRound + recalled_[r].round,
           recalled_[r].reflected, chosen_.size() + r);
    }
    rays_.flush(arrived_);
  }

  void combine(Plane<Reservoir>& reservoirs, std::span<Rgb> slots) {
    std::size_t c = 0, r = 0;
    for (std::uint32_t point = 0; point < tile_.points.count; ++point) {
      Keeper keeper(tile_.points.keys[point]);
      float confidence = 1.0F;
      for (; c < chosen_.size() && chosen_[c].point == point; ++c) {
        keeper.offer(chosen_[c].shares * arrived_[c], chosen_[c].ask,
                     image::luminance(chosen_[c].reflected) / chosen_[c].ask.inverse_probability);
      }
      for (; r < recalled_.size() && recalled_[r].point == point; ++r) {
        const Recalled& other = recalled_[r];
        keeper.offer(remembered(other, arrived_[chosen_.size() + r]), unit(other.reservoir),
                     image::luminance(arrived_[chosen_.size() + r]));
        confidence += other.reservoir.confidence / static_cast<float>(pairs_[point]);
      }
      slots[point] += keeper.sum();
      const image::Pixel pixel = tile_.pixel(point);
      reservoirs(pixel.x, pixel.y) =
          keeper.kept(reflectance(point), std::min(confidence, config_.most_confidence));
    }
  }
  Rgb reflectance(std::uint32_t point) const {
    constexpr float kLeast = 1e-3F;
    return glm::max(tile_.points.reflectors.reflectance[point], Rgb{kLeast});
  }
  /// `arrives`: with unit weight.
  Rgb remembered(const Recalled& other, const Rgb& arrives) const {
    const float here = image::luminance(arrives);
    const PairedTargets targets{here, other.reservoir.confidence * other.target_there};
    const float weight = other_share(targets, pairs_[other.point]) * other.reservoir.weight;
    const Rgb colour = other.reservoir.colour * reflectance(other.point);
    const float luminance = image::luminance(colour);
    if (!config_.blends_colours || !(luminance > 0.0F)) return weight * arrives;
    return (weight * here / luminance) * colour;
  }

  /// One of the values that were added, in proportion to its luminance.
  class Keeper {
   public:
    explicit Keeper(sampling::SampleKey key) : key_(key) {}

    void offer(const Rgb& value, const Ask& ask, float target) {
      const float mine = image::luminance(value);
      all_ += value;
      if (!(mine > 0.0F) || !(target > 0.0F)) return;
      sum_ += mine;
      if (sampling::sample(key_, kKeepDimension + offered_++) * sum_ > mine) return;
      kept_.light = ask.light, kept_.u = ask.u;
      target_ = target;
    }
    const Rgb& sum() const { return all_; }
    Reservoir kept(const Rgb& reflectance, float confidence) const {
      Reservoir reservoir = kept_;
      const Rgb light = all_ / reflectance;
      const float luminance = image::luminance(light);
      if (luminance > 0.0F) reservoir.colour = light / luminance;
      reservoir.weight = sum_ > 0.0F ? sum_ / target_ : 0.0F;
      reservoir.confidence = confidence;
      return reservoir;
    }

   private:
    sampling::SampleKey key_;
    Reservoir kept_;
    Rgb all_{0.0F};
    float sum_ = 0.0F, target_ = 1.0F;
    std::uint32_t offered_ = 0;
  };

  const SceneFrame& scene_;
  const SurfaceTile& tile_;
  const CutPlan& plan_;
  const ReservoirConfig& config_;
  const KeptView* last_;
  const View& view_;
  CutWork& work_;
  LightQuestions questions_;
  ShadowRays rays_;
  std::array<Answer, sampling::kBatch> answers_;
  std::vector<Drawn> drawn_;
  std::vector<Chosen> chosen_;
  std::vector<Vec3> ends_, recalled_ends_;
  std::vector<Recalled> recalled_;
  std::vector<int> pairs_;
  std::vector<Rgb> arrived_;
};

}  // namespace

void add_reservoir_light(const SceneFrame& scene, const SurfaceTile& tile, const CutPlan& plan,
                         const ReservoirConfig& config, const KeptView* last, const View& view,
                         CutWork& work, Plane<Reservoir>& reservoirs, std::span<Rgb> slots) {
  if (scene.placed_lights().size() == 0) return;
  TileReservoirs(scene, tile, plan, config, last, view, work).run(reservoirs, slots);
}

}  // namespace macula::kernels::lightcuts
