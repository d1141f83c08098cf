// Scenes under a light of an experiment's own, seen from where they say. World meters.
#pragma once

#include "server/kernels/scene_frame.h"

namespace macula::bench {

/// World from view: the scene's first camera at time 0, or an eye that stands on its stage.
Pose starting_pose(const scene::Scene& scene);
/// Nothing shines any more.
void switch_off(scene::Scene& scene);
/// Above the eye, three quarters of the way to what is there, at most 4 m up.
Vec3 lamp_place(const kernels::SceneFrame& scene, const Pose& eye);
/// Exposure that brings the mean luminance of a picture to middle grey (0.18); 0 EV for a black
/// one.
float exposure_for(const image::Plane<Rgb>& radiance);

}  // namespace macula::bench
