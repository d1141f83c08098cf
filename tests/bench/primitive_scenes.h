// Distance fields of any number of primitives that cover about the same share of a picture, so that
// what is measured over them is the price of their number.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/scene/scene.h"

namespace macula::bench {

/// N of "primitives-N", 1 to 20000; none for other names.
std::optional<int> primitive_count(std::string_view name);

/// A scene file: `count` primitives of six kinds on a disc of 4 m around the origin, side by side
/// like the seeds of a sunflower, each as large as a `count`-th of the disc, up to 1 m before or
/// behind it, seen by the camera "front" and lit by a sun.
std::string primitive_scene_text(int count);
std::shared_ptr<const scene::Scene> primitive_scene(int count);

}  // namespace macula::bench
