#include "server/kernels/ray/foveated.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "server/kernels/parcels.h"
#include "server/kernels/planes.h"
#include "server/kernels/ray/cache.h"
#include "server/kernels/ray/carry_over.h"
#include "server/kernels/ray/fresh.h"
#include "server/kernels/ray/merge.h"
#include "server/kernels/ray/reproject.h"
#include "server/kernels/ray/resampling.h"
#include "server/kernels/ray/sampling_mask.h"
#include "server/kernels/ray/support.h"
#include "server/kernels/ray/tile.h"
#include "shared/base/check.h"
#include "shared/base/cpu_time.h"

namespace macula::kernels::ray {
namespace {

using scheduling::Outcome;

constexpr unsigned kRemembered = kSurfaceId | kNormal | kAlbedo;
/// Depths of the rows beside a task's own are found twice.
constexpr int kRowsPerTask = 32;

/// A scheduler whose tasks' CPU time is summed into one stage of the report.
class Stage {
 public:
  Stage(TileScheduler& scheduler, double& total_ms) : scheduler_(scheduler), total_ms_(total_ms) {}

  template <class Body>
  Outcome run(std::size_t count, Body&& body) {
    std::vector<double> spent(count, 0.0);
    const Outcome outcome = scheduler_.run(count, timed(body, spent));
    for (const double ms : spent) total_ms_ += ms;
    return outcome;
  }
  /// Tasks that may run on other ranks, whose time is not counted here.
  template <class Places, class Body, class Outputs>
  Outcome run_shared(std::size_t count, const Places& places, Body&& body, const Outputs& outputs) {
    std::vector<double> spent(count, 0.0);
    const Outcome outcome = scheduling::run_shared(scheduler_, count, Audience::EveryRank, places,
                                                   timed(body, spent), outputs);
    for (const double ms : spent) total_ms_ += ms;
    return outcome;
  }

 private:
  template <class Body>
  static auto timed(Body& body, std::vector<double>& spent) {
    return [&body, &spent](std::size_t index) {
      const double begin = base::thread_cpu_ms();
      body(index);
      spent[index] = base::thread_cpu_ms() - begin;
    };
  }

  TileScheduler& scheduler_;
  double& total_ms_;
};

/// Area and ambient light are estimated by chance and remembered on their own.
bool has_sampled_light(const SceneFrame& scene, const Config& config) {
  const bool ambient = config.ambient_samples > 0 && scene.plan().has(scene::Step::Ambient);
  return ambient || scene.plan().has(scene::Step::Environment) ||
         !scene.lights().emissive().empty();
}

/// One view of one frame.
class ViewFrame {
 public:
  ViewFrame(const FrameRequest& request, std::size_t index, const SceneFrame& scene,
            const Config& config, const GlossyTurn& turns, RayRecord& record,
            TileScheduler& scheduler, FrameBuffers& out)
      : request_(request),
        index_(index),
        view_(request.views[index]),
        config_(config),
        record_(record),
        memory_(record.views[index]),
        scheduler_(scheduler),
        out_(out.views[index]),
        has_light_(has_sampled_light(scene, config)),
        turns_(turns),
        context_(view_, scene, config, request,
                 (out.wanted & kRemembered) | kNormal | (has_light_ ? kLight : 0U) |
                     (turns.any() ? kSurfaceId : 0U)),
        support_(view_.grid, config.foveated.support_spacing),
        probability_(request.foveation.view(index), request.foveation.model(), memory_.density),
        mask_(support_, view_.grid.width(), view_.grid.height()),
        fresh_(memory_.fresh) {}

  FrameReport run(Motion scene_motion) {
    memory_.eyes.note(record_.clock, view_.world_from_view.position);
    choose();
    fresh_.prepare(view_.grid.width(), view_.grid.height(), context_.wanted,
                   mask_.chosen().size() + mask_.most_resampled(config_.foveated));
    Outcome outcome = trace(mask_.chosen());
    if (outcome == Outcome::Completed) {
      support_.fill(fresh_, config_.foveated);
      outcome = remember(scene_motion);
    }
    if (outcome == Outcome::Completed) outcome = resample();
    if (outcome == Outcome::Completed) outcome = merge();
    keep_to_budget();
    report_.stopped = outcome == Outcome::Stopped;
    // A picture half written is nothing to remember.
    if (report_.stopped) memory_.grid = {};
    return report_;
  }

 private:
  void choose() {
    const double begin = base::thread_cpu_ms();
    mask_.choose(probability_, request_.frame, request_.seed, config_.foveated, scheduler_);
    report_.mask_ms += base::thread_cpu_ms() - begin;
  }

  void keep_to_budget() {
    const auto traced = static_cast<float>(mask_.chosen().size() + mask_.resampled().size());
    const auto cells = static_cast<float>(out_.radiance.size());
    const float budget = config_.foveated.ray_budget;
    memory_.density = budget < 1.0F ? next_density(memory_.density, traced / cells, budget) : 1.0F;
  }

  Outcome trace(const std::vector<image::Pixel>& cells) {
    std::vector<FrameReport> parts(FreshSamples::batch_count(cells.size()));
    const int first_row = fresh_.place(cells);
    const auto rect_of = [&](std::size_t batch) {
      return image::Rect{0, first_row + static_cast<int>(batch),
                         static_cast<int>(batch_of(cells, batch).size()), 1};
    };
    const Outcome outcome = Stage(scheduler_, report_.sample_ms)
                                .run_shared(
                                    parts.size(), by_batches(cells, kBatch, view_.grid, index_),
                                    [&](std::size_t batch) {
                                      parts[batch] =
                                          render_batch(batch_of(cells, batch), rect_of(batch).y);
                                    },
                                    [&](std::size_t batch, Parcel& parcel) {
                                      kernels::carry(parts[batch], parcel);
                                      kernels::carry(fresh_.planes(), rect_of(batch), parcel);
                                      parcel.rect(fresh_.chroma(), rect_of(batch));
                                    });
    for (const FrameReport& part : parts) report_ += part;
    return outcome;
  }
  FrameReport render_batch(std::span<const image::Pixel> cells, int row) {
    const FrameReport part = render_cells(context_, cells, row, fresh_.planes());
    fresh_.add_chroma(row, cells.size());
    return part;
  }
  static constexpr std::size_t kBatch = FreshSamples::kBatch;
  static std::span<const image::Pixel> batch_of(const std::vector<image::Pixel>& cells,
                                                std::size_t batch) {
    const std::size_t first = batch * kBatch;
    return std::span(cells).subspan(first, std::min(kBatch, cells.size() - first));
  }

  /// body(first, last) for all rows, a few at a time.
  template <class Body>
  Outcome in_rows(double& total_ms, const Body& body) {
    return Stage(scheduler_, total_ms).run(row_tasks(), [&](std::size_t task) {
      const int first = static_cast<int>(task) * kRowsPerTask;
      body(first, std::min(first + kRowsPerTask, view_.grid.height()));
    });
  }
  std::size_t row_tasks() const {
    return static_cast<std::size_t>(view_.grid.height() + kRowsPerTask - 1) / kRowsPerTask;
  }

  /// Leaves in memory_.now, and in the frame, what is remembered as this view sees it, and what the
  /// chosen cells brought.
  Outcome remember(Motion scene_motion) {
    const int width = view_.grid.width(), height = view_.grid.height();
    const bool same_view = memory_.grid == view_.grid && same_pose();
    motion_ = same_view ? scene_motion : Motion::Moving;
    remembers_ = memory_.grid.width() > 0;
    if (remembers_ && !same_view) {
      std::swap(memory_.now, memory_.then);
    } else {
      std::swap(memory_.now.inverse_depth, memory_.then.inverse_depth);
    }
    prepare_cache(memory_.now, width, height, has_light_, record_.wanted);
    if (!remembers_) {
      memory_.then.inverse_depth.resize(width, height);
      std::ranges::fill(memory_.then.inverse_depth.pixels(), Cache::kNothing);
    }
    const Outcome outcome = carry_over(remembers_ && !same_view);
    memory_.world_from_view = view_.world_from_view;
    memory_.grid = view_.grid;
    return outcome;
  }
  Outcome carry_over(bool moved) {
    const ReprojectJob job{memory_.then, memory_.world_from_view, memory_.grid,  view_,
                           support_,     config_.foveated,        request_.frame};
    std::optional<Reprojector> reprojector;
    if (moved) reprojector.emplace(job, memory_.now);
    luminance_.remembered.resize(support_.x.count(), support_.y.count());
    luminance_.fresh.resize(support_.x.count(), support_.y.count());
    const MergeJob merge = merge_job();
    const CarryOver carrying(merge, reprojector ? &*reprojector : nullptr,
                             memory_.then.inverse_depth, memory_.now, out_, luminance_);
    std::vector<CarryOver::Brought> brought(row_tasks());
    const Outcome outcome = in_rows(report_.reproject_ms, [&](int first, int last) {
      brought[first / kRowsPerTask] = carrying.rows(first, last);
    });
    for (const CarryOver::Brought& rows : brought) {
      report_.reproject_ms -= rows.joining_ms, report_.cache_ms += rows.joining_ms;
      forgotten_.insert(forgotten_.end(), rows.forgotten.begin(), rows.forgotten.end());
    }
    return outcome;
  }
  bool same_pose() const {
    return memory_.world_from_view.position == view_.world_from_view.position &&
           memory_.world_from_view.rotation == view_.world_from_view.rotation;
  }

  Outcome resample() {
    const double begin = base::thread_cpu_ms();
    Plane<float> scores(support_.broken.width(), support_.broken.height(), 0.0F);
    if (remembers_) {
      scores = resampling_scores({view_, support_, fresh_, memory_.now, luminance_,
                                  config_.foveated, motion_, glossy_past()});
      weigh_by_rate(scores);
    }
    mask_.resample(std::move(forgotten_), memory_.now, scores, request_.frame, config_.foveated,
                   scheduler_);
    report_.mask_ms += base::thread_cpu_ms() - begin;
    report_.resampled_cells += mask_.counts().resampled;
    return trace(mask_.resampled());
  }
  GlossyPast glossy_past() const {
    if (!turns_.any() || motion_ == Motion::Still) return {};
    return {&turns_, memory_.eyes.ways(view_.world_from_view), memory_.eyes.newest(),
            config_.foveated.turn_threshold};
  }
  /// What is urgent is the more so the better the eye sees there.
  void weigh_by_rate(Plane<float>& scores) const {
    for (int j = 0; j < scores.height(); ++j) {
      for (int i = 0; i < scores.width(); ++i) {
        if (scores(i, j) <= 0.0F) continue;
        scores(i, j) *= probability_.at(support_.x.cells[i], support_.y.cells[j]);
      }
    }
  }

  MergeJob merge_job() const {
    return {view_,         support_, mask_,         fresh_,        config_.foveated,
            record_.clock, motion_,  glossy_past(), request_.frame};
  }
  Outcome merge() {
    const MergeJob job = merge_job();
    Outcome outcome = in_batches(mask_.resampled(), report_.cache_ms, [&](auto cells) {
      update_cells(job, cells, memory_.now, out_.radiance);
    });
    if (outcome == Outcome::Completed) {
      outcome = in_batches(mask_.resampled(), report_.cache_ms, [&](auto cells) {
        finish_cells(job, cells, memory_.now, out_.depth_m);
      });
    }
    return outcome == Outcome::Completed ? write(job) : outcome;
  }
  /// body(some of the cells) until all were.
  template <class Body>
  Outcome in_batches(const std::vector<image::Pixel>& cells, double& total_ms, const Body& body) {
    return Stage(scheduler_, total_ms)
        .run(FreshSamples::batch_count(cells.size()),
             [&](std::size_t batch) { body(batch_of(cells, batch)); });
  }

  Outcome write(const MergeJob& job) {
    report_.filled_cells += mask_.unknown().size();
    Outcome outcome = in_batches(mask_.unknown(), report_.merge_ms,
                                 [&](auto cells) { fill_cells(job, cells, memory_.now, out_); });
    if (outcome == Outcome::Completed && config_.foveated.post_filter == PostFilter::On) {
      outcome = in_batches(mask_.resampled(), report_.post_ms, [&](auto cells) {
        post_filter_cells(job, cells, memory_.now, out_.radiance);
      });
    }
    if (outcome == Outcome::Stopped) return outcome;
    return in_rows(report_.merge_ms,
                   [&](int first, int last) { copy_rows(memory_.now, first, last, out_); });
  }

  const FrameRequest& request_;
  std::size_t index_;
  const View& view_;
  const Config& config_;
  RayRecord& record_;
  ViewMemory& memory_;
  TileScheduler& scheduler_;
  ViewBuffers& out_;
  bool has_light_;
  const GlossyTurn& turns_;
  ViewContext context_;
  Support support_;
  Probability probability_;
  SamplingMask mask_;
  FreshSamples& fresh_;
  FrameReport report_;
  Motion motion_ = Motion::Moving;
  bool remembers_ = false;
  std::vector<image::Pixel> forgotten_;
  SupportLuminance luminance_;
};

/// The history's record, empty where it is another kernel's or was made for other planes.
RayRecord& open_record(History& history, std::size_t views, unsigned wanted) {
  auto* record = dynamic_cast<RayRecord*>(history.record.get());
  if (record == nullptr || record->views.size() != views || record->wanted != wanted) {
    auto fresh = std::make_unique<RayRecord>();
    fresh->views.resize(views);
    fresh->wanted = wanted;
    record = fresh.get();
    history.record = std::move(fresh);
  }
  return *record;
}

/// Whether any view of the frame differs from what is remembered of it.
bool any_view_moved(const RayRecord& record, std::span<const View> views) {
  for (std::size_t v = 0; v < views.size(); ++v) {
    const ViewMemory& memory = record.views[v];
    if (!(memory.grid == views[v].grid) ||
        memory.world_from_view.position != views[v].world_from_view.position ||
        memory.world_from_view.rotation != views[v].world_from_view.rotation) {
      return true;
    }
  }
  return false;
}

void name_shortcuts(const Config& config, FrameReport& report) {
  auto& shortcuts = report.biased_shortcuts;
  shortcuts.emplace_back("cells are remembered from earlier frames and filtered to this view");
  shortcuts.emplace_back("new samples are blended with what is remembered of their cell");
  shortcuts.emplace_back("cells that were never seen are filled from every fifth column and row");
  shortcuts.emplace_back("light of area and ambient sources is averaged apart from reflectance");
  if (config.foveated.clipping == Clipping::On) {
    shortcuts.emplace_back("what is remembered is held within the colours of new neighbours");
  }
  if (config.foveated.post_filter == PostFilter::On) {
    shortcuts.emplace_back("resampled cells show the light of their neighbours");
  }
}

}  // namespace

FrameReport render_foveated(const FrameRequest& request, const SceneFrame& scene,
                            const Config& config, History& history, TileScheduler& scheduler,
                            FrameBuffers& out) {
  MACULA_CHECK(request.foveation.view_count() == request.views.size());
  RayRecord& record = open_record(history, request.views.size(), out.wanted & kRemembered);
  const Motion scene_motion = record.scene == &scene ? Motion::Still : Motion::Moving;
  const bool moved = scene_motion == Motion::Moving || any_view_moved(record, request.views);
  if (moved || config.foveated.age == AgeRule::AllFrames) ++record.clock;
  record.scene = &scene;
  const GlossyTurn turns(scene, config);
  FrameReport report;
  for (std::size_t v = 0; v < request.views.size() && !report.stopped; ++v) {
    ViewFrame frame(request, v, scene, config, turns, record, scheduler, out);
    const FrameReport part = frame.run(scene_motion);
    report += part;
    report.stopped = part.stopped;
  }
  if (report.stopped) history.record.reset();
  name_shortcuts(config, report);
  return report;
}

}  // namespace macula::kernels::ray
