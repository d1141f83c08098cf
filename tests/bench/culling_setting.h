// What `macula-bench culling` looks at: a scene under one lamp of its own, square pictures of 90
// degrees from a still eye that looks ahead, and what moves. World meters.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/kernels/kernel.h"
#include "server/kernels/scene_timeline.h"

namespace macula::bench {

/// The lamp, a red ball, both or neither go round in circles.
enum class SceneMotion { Still, Light, Object, Both };
/// static, light, object, both.
Result<SceneMotion> find_motion(const std::string& name);

class CullingSetting {
 public:
  /// Every surface diffuse, in its base colour.
  static Result<CullingSetting> create(const std::string& scene, SceneMotion motion, int side_px);

  static constexpr double kRate_hz = 30.0;
  /// 150 of 1024 pixels.
  static Degrees fovea();

  /// The scene in frame `frame` of its motion.
  Result<std::shared_ptr<const kernels::SceneFrame>> frame(int frame) const;
  struct Eye {
    kernels::View view;
    std::shared_ptr<const FoveationMap> map;
  };
  const Eye& eye() const { return eye_; }
  const kernels::View& view() const { return eye_.view; }
  const FoveationMap& map() const { return *eye_.map; }
  /// The same eye; the middles of its cells are those of pixels kThinning * cell + kThinning / 2.
  static constexpr int kThinning = 4;
  Eye thinned_eye() const;
  const foveation::Display& display() const { return display_; }
  const scene::Scene& scene() const { return timeline_->scene(); }
  void set_exposure(float ev) { eye_.view.tone.exposure_ev = ev; }

 private:
  std::shared_ptr<kernels::SceneTimeline> timeline_;
  foveation::Display display_;
  Eye eye_;
};

/// Blocks of 4 x 4 pixels, every eighth each way: a 64th of the picture, in the order of tiles.
std::vector<image::Pixel> sample_of_blocks(const foveation::Display& display);

}  // namespace macula::bench
