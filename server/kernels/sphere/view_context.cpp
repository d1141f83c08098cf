#include "server/kernels/sphere/view_context.h"

#include <utility>

#include "shared/base/check.h"

namespace macula::kernels::sphere {
namespace {

sdf::Method method_of(Tracing tracing) {
  switch (tracing) {
    case Tracing::Full:
      return sdf::Method::Full;
    case Tracing::FullBest:
      return sdf::Method::FullBest;
    case Tracing::PaperPyramid:
    case Tracing::Pyramid:
      return sdf::Method::Cones;
  }
  return sdf::Method::Cones;
}

}  // namespace

double seconds_of(SceneTime time) {
  return std::chrono::duration<double>(time.since_start).count();
}

ViewContext::ViewContext(const View& shown, const SceneFrame& frame_scene, const Config& settings,
                         const FrameRequest& request, unsigned planes)
    : view(shown),
      scene(frame_scene),
      config(settings),
      program(sdf::compile(*frame_scene.scene().field, seconds_of(frame_scene.time()),
                           shown.world_from_view.position)),
      scene_from_view(glm::mat3_cast(shown.world_from_view.rotation)),
      forward(-scene_from_view[2]),
      lighting(frame_scene, settings, shown.world_from_view.position),
      frame(request.frame),
      seed(request.seed),
      wanted(planes) {}

sdf::Tracer make_tracer(const ViewContext& context, const PixelGrid& grid, int samples, int side) {
  sdf::TraceOptions options;
  options.method = method_of(context.config.tracing);
  options.samples = samples;
  options.hit_pixels /= static_cast<float>(side);
  auto tracer = sdf::Tracer::create(context.program, context.scene_from_view, grid, options);
  MACULA_CHECK(tracer.has_value(), "a kernel's options are checked when it is made");
  return std::move(*tracer);
}

std::unique_ptr<sdf::TraceWorkspace> WorkspacePool::take() {
  const std::scoped_lock lock(mutex_);
  if (idle_.empty()) return std::make_unique<sdf::TraceWorkspace>();
  auto workspace = std::move(idle_.back());
  idle_.pop_back();
  return workspace;
}

void WorkspacePool::give_back(std::unique_ptr<sdf::TraceWorkspace> workspace) {
  const std::scoped_lock lock(mutex_);
  idle_.push_back(std::move(workspace));
}

}  // namespace macula::kernels::sphere
