// What `macula-bench ray` looks at: a scene under one of the paper's lightings, the DK2's eye, the
// path it moves along. World meters; pure but for building the scene's structures.
#pragma once

#include <memory>
#include <string>

#include "server/kernels/kernel.h"
#include "server/kernels/scene_frame.h"
#include "server/shading/material_table.h"
#include "shared/foveation/pixel_grid.h"

namespace macula::bench {

enum class PaperLighting { Point, Area8, Ao16 };
Result<PaperLighting> find_lighting(const std::string& name);

/// World from view after `seconds` of turns of the head and a slow sway; `start` at 0.
Pose swayed(const Pose& start, double seconds);

struct RaySetting {
  std::shared_ptr<const kernels::SceneFrame> scene;
  PaperLighting lighting = PaperLighting::Point;
  shading::MaterialModel materials = shading::MaterialModel::AsInScene;
  foveation::Display display;
  Pose start;        ///< world from view where the path begins
  Vec3 light{0.0F};  ///< where the lamp hangs, world meters
  image::Tone tone;  ///< exposure: the mean of the first picture at middle grey

  /// World from view after `seconds` on the path: turns of the head and a slow sway.
  Pose pose_at(double seconds) const;
  /// One lamp above the eye, its area version, or an open environment; nothing else shines.
  static Result<RaySetting> make(std::shared_ptr<const scene::Scene> scene, PaperLighting lighting,
                                 shading::MaterialModel materials, int width_px, int height_px);
};

}  // namespace macula::bench
