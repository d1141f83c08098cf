// What the passes over one view share. Lives for one frame; the references outlive it.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "server/kernels/kernel.h"
#include "server/kernels/sphere/config.h"
#include "server/kernels/sphere/lighting.h"
#include "server/sdf/tracer.h"

namespace macula::kernels::sphere {

struct ViewContext {
  const View& view;
  const SceneFrame& scene;
  const Config& config;
  sdf::Program program;  ///< the field at the frame's moment, seen from the view's eye
  DMat3 scene_from_view;
  Vec3 forward{0.0F};  ///< unit, scene orientation: depth = t * dot(direction, forward)
  Lighting lighting;
  std::uint64_t frame = 0, seed = 0;
  unsigned wanted = 0;

  ViewContext(const View& view, const SceneFrame& scene, const Config& config,
              const FrameRequest& request, unsigned wanted);
};

/// Seconds on the scene's clock.
double seconds_of(SceneTime time);

/// A tracer over `grid` whose hits are as exact as those of the view's own cells, whatever the
/// grid's: `side` cells of the view's along one of the grid's.
sdf::Tracer make_tracer(const ViewContext& context, const PixelGrid& grid, int samples, int side);

/// Workspaces that tiles borrow: as many as tiles run at once.
class WorkspacePool {
 public:
  class Loan {
   public:
    explicit Loan(WorkspacePool& pool) : pool_(pool), workspace_(pool.take()) {}
    ~Loan() { pool_.give_back(std::move(workspace_)); }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    sdf::TraceWorkspace& operator*() { return *workspace_; }

   private:
    WorkspacePool& pool_;
    std::unique_ptr<sdf::TraceWorkspace> workspace_;
  };

 private:
  std::unique_ptr<sdf::TraceWorkspace> take();
  void give_back(std::unique_ptr<sdf::TraceWorkspace> workspace);

  std::mutex mutex_;
  std::vector<std::unique_ptr<sdf::TraceWorkspace>> idle_;
};

}  // namespace macula::kernels::sphere
