// SceneTimeline: the SceneFrames of a scene over time. The frame of a moment is made once and
// shared by all who ask while anybody has it; a frame in use never changes, and one that nobody
// uses any more is moved to the next moment instead of being built anew. Where nothing moves there
// is one frame for all times. The same time gives the same frame whichever came before.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "server/kernels/scene_frame.h"
#include "server/visibility/moving_triangles.h"

namespace macula::kernels {

/// What surfaces of a moment reflect of its lamps' light: a pure function of the frame, which has
/// everything but these lights. Called by one thread at a time; must not ask the timeline.
using BouncedLight = std::function<std::vector<lights::VirtualPointLight>(const SceneFrame&)>;

class SceneTimeline {
 public:
  /// Builds what stands still, on all cores. Errors: those of visibility::TriangleScene::create.
  /// With `bounced`, every moment's light tree holds its virtual lights behind the lamps.
  static Result<std::shared_ptr<SceneTimeline>> create(std::shared_ptr<const scene::Scene> scene,
                                                       const scene::ScenePlan& plan,
                                                       BouncedLight bounced = {});
  /// By the scene's own plan.
  static Result<std::shared_ptr<SceneTimeline>> create(std::shared_ptr<const scene::Scene> scene);

  /// Thread-safe; who asks for a new moment makes it, others wait. Errors: memory runs out.
  Result<std::shared_ptr<const SceneFrame>> at(SceneTime time);

  const scene::Scene& scene() const { return *still_->scene; }
  bool moves() const { return moves_; }
  struct Counters {
    std::size_t moments = 0;  ///< frames made or moved, at() calls that found none
    std::size_t frames = 0;   ///< in memory, idle ones too
  };
  Counters counters() const;

 private:
  using Frame = std::unique_ptr<SceneFrame>;
  /// Frames nobody reads. Outlives the timeline while frames of it are read.
  struct Pool {
    std::mutex mutex;
    std::vector<Frame> idle;
  };

  SceneTimeline(std::shared_ptr<const scene::Scene> scene, const scene::ScenePlan& plan,
                BouncedLight bounced);
  Result<void> build();
  Result<Frame> new_frame();
  Result<Frame> idle_or_new_frame();
  Result<void> move(SceneFrame& frame, SceneTime time);
  void place_lights(SceneFrame& frame) const;
  std::shared_ptr<const SceneFrame> share(Frame frame);

  std::shared_ptr<const SceneFrame::Still> still_;
  scene::MovingParts moving_;      ///< as far as the plan lets it
  scene::MovingParts relighting_;  ///< what the light list follows
  BouncedLight bounced_;           ///< none: lamps alone
  bool moves_ = false;

  mutable std::mutex mutex_;
  std::unique_ptr<visibility::MovingTriangles> moving_triangles_;  ///< none: triangles stand still
  std::unique_ptr<const SceneFrame> pattern_;  ///< at time 0; new frames begin as copies
  std::shared_ptr<const SceneFrame> newest_;
  std::vector<std::weak_ptr<const SceneFrame>> living_;
  std::shared_ptr<Pool> pool_ = std::make_shared<Pool>();
  Counters counters_;
};

}  // namespace macula::kernels
