#include "server/kernels/ray/foveated.h"

#include <algorithm>
#include <utility>

#include "server/kernels/planes.h"
#include "server/kernels/ray/cache.h"
#include "server/kernels/ray/merge.h"
#include "server/kernels/ray/reproject.h"
#include "server/kernels/ray/resampling.h"
#include "server/kernels/ray/sampling_mask.h"
#include "server/kernels/ray/support.h"
#include "server/kernels/ray/tile.h"
#include "server/scheduling/cpu_time.h"
#include "shared/base/check.h"

namespace macula::kernels::ray {
namespace {

using scheduling::Outcome;

constexpr unsigned kRemembered = kSurfaceId | kNormal | kAlbedo;
constexpr int kRowsPerTask = 8;

/// A scheduler whose tasks' CPU time is summed into one stage of the report.
class Stage {
 public:
  Stage(TileScheduler& scheduler, double& total_ms) : scheduler_(scheduler), total_ms_(total_ms) {}

  template <class Body>
  Outcome run(std::size_t count, Body&& body) {
    std::vector<double> spent(count, 0.0);
    const Outcome outcome = scheduler_.run(count, [&](std::size_t index) {
      const double begin = scheduling::thread_cpu_ms();
      body(index);
      spent[index] = scheduling::thread_cpu_ms() - begin;
    });
    for (const double ms : spent) total_ms_ += ms;
    return outcome;
  }

 private:
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
            const Config& config, RayRecord& record, TileScheduler& scheduler, FrameBuffers& out)
      : request_(request),
        index_(index),
        view_(request.views[index]),
        config_(config),
        record_(record),
        memory_(record.views[index]),
        scheduler_(scheduler),
        out_(out.views[index]),
        has_light_(has_sampled_light(scene, config)),
        context_(view_, scene, config, request,
                 (out.wanted & kRemembered) | kNormal | (has_light_ ? kLight : 0U)),
        support_(view_.grid, config.foveated.support_spacing),
        mask_(support_, view_.grid.width(), view_.grid.height()),
        fresh_(memory_.fresh) {}

  FrameReport run(Motion scene_motion) {
    Outcome outcome = trace_support();
    if (outcome == Outcome::Completed) outcome = remember(scene_motion);
    if (outcome == Outcome::Completed) outcome = trace_mask();
    if (outcome == Outcome::Completed) outcome = merge();
    report_.stopped = outcome == Outcome::Stopped;
    // A picture half written is nothing to remember.
    if (report_.stopped) memory_.grid = {};
    return report_;
  }

 private:
  Outcome trace_support() {
    prepare_fresh();
    mask_.mark_support();
    const Outcome outcome = trace(mask_.support_cells());
    if (outcome == Outcome::Completed) support_.fill(fresh_, config_.foveated);
    return outcome;
  }

  void prepare_fresh() {
    FrameBuffers buffers;
    buffers.wanted = context_.wanted;
    buffers.views.push_back(std::move(fresh_));
    prepare_buffers({&view_, 1}, buffers);
    fresh_ = std::move(buffers.views.front());
  }

  Outcome trace(const std::vector<image::Pixel>& cells) {
    constexpr std::size_t kBatch = kTileSide * kTileSide;
    std::vector<FrameReport> parts((cells.size() + kBatch - 1) / kBatch);
    const Outcome outcome =
        Stage(scheduler_, report_.sample_ms).run(parts.size(), [&](std::size_t batch) {
          parts[batch] = render_cells(context_, batch_of(cells, batch), fresh_);
        });
    for (const FrameReport& part : parts) report_ += part;
    return outcome;
  }
  static std::span<const image::Pixel> batch_of(const std::vector<image::Pixel>& cells,
                                                std::size_t batch) {
    constexpr std::size_t kBatch = kTileSide * kTileSide;
    const std::size_t first = batch * kBatch;
    return std::span(cells).subspan(first, std::min(kBatch, cells.size() - first));
  }

  /// Leaves in memory_.now what is remembered as this view sees it.
  Outcome remember(Motion scene_motion) {
    const int width = view_.grid.width(), height = view_.grid.height();
    const bool same_view = memory_.grid == view_.grid && same_pose();
    motion_ = same_view ? scene_motion : Motion::Moving;
    remembers_ = memory_.grid.width() > 0;
    if (!remembers_) {
      prepare_cache(memory_.now, width, height, has_light_, record_.wanted);
      std::ranges::fill(memory_.now.inverse_depth.pixels(), Cache::kNothing);
    } else if (!same_view) {
      std::swap(memory_.now, memory_.then);
      prepare_cache(memory_.now, width, height, has_light_, record_.wanted);
      const ReprojectJob job{memory_.then, memory_.world_from_view, memory_.grid,  view_,
                             support_,     config_.foveated,        request_.frame};
      const int tasks = (height + kRowsPerTask - 1) / kRowsPerTask;
      const Reprojector reprojector(job, memory_.now);
      const Outcome outcome = Stage(scheduler_, report_.reproject_ms)
                                  .run(static_cast<std::size_t>(tasks), [&](std::size_t task) {
                                    const int first = static_cast<int>(task) * kRowsPerTask;
                                    reprojector.rows(first, std::min(first + kRowsPerTask, height));
                                  });
      if (outcome == Outcome::Stopped) return outcome;
    }
    memory_.world_from_view = view_.world_from_view;
    memory_.grid = view_.grid;
    return Outcome::Completed;
  }
  bool same_pose() const {
    return memory_.world_from_view.position == view_.world_from_view.position &&
           memory_.world_from_view.rotation == view_.world_from_view.rotation;
  }

  Outcome trace_mask() {
    const double begin = scheduling::thread_cpu_ms();
    const auto& map = request_.foveation;
    const Probability probability(map.view(index_), map.model());
    mask_.draw(probability, remembers_ ? &memory_.now : nullptr, request_.frame, request_.seed,
               config_.foveated, scheduler_);
    Plane<float> scores(support_.broken.width(), support_.broken.height(), 0.0F);
    if (remembers_) {
      scores = resampling_scores({view_, support_, fresh_, memory_.now, config_.foveated, motion_});
      weigh_by_rate(probability, scores);
    }
    mask_.resample(scores, request_.frame, config_.foveated, scheduler_);
    cells_ = mask_.other_cells(scheduler_);
    report_.mask_ms += scheduling::thread_cpu_ms() - begin;
    report_.resampled_cells += mask_.counts().resampled;
    return trace(cells_);
  }
  /// What is urgent is the more so the better the eye sees there.
  void weigh_by_rate(const Probability& probability, Plane<float>& scores) const {
    for (int j = 0; j < scores.height(); ++j) {
      for (int i = 0; i < scores.width(); ++i) {
        if (scores(i, j) <= 0.0F) continue;
        scores(i, j) *= probability.at(support_.x.cells[i], support_.y.cells[j]);
      }
    }
  }

  Outcome merge() {
    const MergeJob job{view_,         support_, mask_,         fresh_, config_.foveated,
                       record_.clock, motion_,  request_.frame};
    for (const bool support : {true, false}) {
      const std::vector<image::Pixel> cells = support ? mask_.support_cells() : std::move(cells_);
      constexpr std::size_t kBatch = kTileSide * kTileSide;
      const Outcome outcome =
          Stage(scheduler_, report_.cache_ms)
              .run((cells.size() + kBatch - 1) / kBatch, [&](std::size_t batch) {
                update_cache(job, batch_of(cells, batch), memory_.now);
              });
      if (outcome == Outcome::Stopped) return outcome;
    }
    return write(job);
  }

  Outcome write(const MergeJob& job) {
    const int height = view_.grid.height();
    const int tasks = (height + kRowsPerTask - 1) / kRowsPerTask;
    std::vector<WriteCounts> parts(static_cast<std::size_t>(tasks));
    const Outcome outcome =
        Stage(scheduler_, report_.merge_ms).run(parts.size(), [&](std::size_t task) {
          const int first = static_cast<int>(task) * kRowsPerTask;
          parts[task] =
              write_frame(job, first, std::min(first + kRowsPerTask, height), memory_.now, out_);
        });
    for (const WriteCounts& part : parts) {
      report_.filled_cells += part.filled;
      report_.post_ms += part.post_ms;
    }
    report_.merge_ms -= report_.post_ms;
    return outcome;
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
  ViewContext context_;
  Support support_;
  SamplingMask mask_;
  ViewBuffers& fresh_;
  FrameReport report_;
  Motion motion_ = Motion::Moving;
  bool remembers_ = false;
  std::vector<image::Pixel> cells_;
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
  FrameReport report;
  for (std::size_t v = 0; v < request.views.size() && !report.stopped; ++v) {
    ViewFrame frame(request, v, scene, config, record, scheduler, out);
    const FrameReport part = frame.run(scene_motion);
    report += part;
    report.stopped = part.stopped;
  }
  if (report.stopped) history.record.reset();
  name_shortcuts(config, report);
  return report;
}

}  // namespace macula::kernels::ray
