#include "server/kernels/culling/knobs.h"

#include <cmath>

#include "server/kernels/ray/knobs.h"

namespace macula::kernels::culling {
namespace {

using CullingKnob = Knob<Config>;

template <bool (*kTurn)(ray::Config&, std::string_view)>
bool turn_tiles(Config& c, std::string_view value) {
  return kTurn(c.ray, value);
}

bool turn_hiding(Config& c, std::string_view value) {
  using Named = std::pair<std::string_view, Hiding>;
  return turn_choice(c.hiding, value,
                     std::array{Named{"rays", Hiding::Rays}, Named{"lamp-maps", Hiding::LampMaps},
                                Named{"nothing", Hiding::Nothing}});
}

bool turn_space(Config& c, std::string_view value) {
  using Named = std::pair<std::string_view, Space>;
  return turn_choice(c.space, value,
                     std::array{Named{"cells", Space::Cells}, Named{"thinned", Space::Thinned},
                                Named{"log-polar", Space::LogPolar}});
}

/// A square number: classes lie side by side in n x n cells.
bool turn_classes(Config& c, std::string_view value) {
  int classes = 0;
  if (!turn_number(classes, value, 1, 64)) return false;
  const int side = static_cast<int>(std::lround(std::sqrt(classes)));
  if (side * side != classes) return false;
  c.classes = classes;
  return true;
}

constexpr std::array kKnobs{
    CullingKnob{"samples", ray::kSamplesAllowed, turn_tiles<ray::turn_samples>},
    CullingKnob{"lights", ray::kLightsAllowed, turn_tiles<ray::turn_lights>},
    CullingKnob{"ambient", ray::kAmbientAllowed, turn_tiles<ray::turn_ambient>},
    CullingKnob{"environment", ray::kLightsAllowed, turn_tiles<ray::turn_environment>},
    CullingKnob{
        "kept", "1 to 65536",
        [](Config& c, std::string_view value) { return turn_number(c.kept, value, 1, 1 << 16); }},
    CullingKnob{"points", "1 to 65536",
                [](Config& c, std::string_view value) {
                  return turn_number(c.shading_points, value, 1, 1 << 16);
                }},
    CullingKnob{
        "map", "1 to 1024",
        [](Config& c, std::string_view value) { return turn_number(c.map_side, value, 1, 1024); }},
    CullingKnob{"wander", "0 to 64",
                [](Config& c, std::string_view value) {
                  return turn_number(c.wander, value, 0.0F, 64.0F);
                }},
    CullingKnob{"by-flux", "0 to 1",
                [](Config& c, std::string_view value) {
                  return turn_number(c.by_flux, value, 0.0F, 1.0F);
                }},
    CullingKnob{"hiding", "rays, lamp-maps, nothing", turn_hiding},
    CullingKnob{"space", "cells, thinned, log-polar", turn_space},
    CullingKnob{"classes", "1, 4, 9, 16, 25, 36, 49, 64", turn_classes},
    CullingKnob{
        "asked", "0 to 1024; 0: all",
        [](Config& c, std::string_view value) { return turn_number(c.asked, value, 0, 1024); }},
    CullingKnob{"nearest", "0 to 1",
                [](Config& c, std::string_view value) {
                  return turn_number(c.nearest, value, 0.0F, 1.0F);
                }},
    CullingKnob{
        "blur", "0 to 16 cells",
        [](Config& c, std::string_view value) { return turn_number(c.blur_reach, value, 0, 16); }},
    CullingKnob{"picture", "1 to 64 frames",
                [](Config& c, std::string_view value) {
                  return turn_number(c.picture_frames, value, 1, 64);
                }},
    CullingKnob{"newest", "0.01 to 1",
                [](Config& c, std::string_view value) {
                  return turn_number(c.newest, value, 0.01F, 1.0F);
                }},
};

}  // namespace

Result<void> turn_knobs(std::span<const KnobValue> values, Config& config) {
  return kernels::turn_knobs("culling", kKnobs, values, config);
}

}  // namespace macula::kernels::culling
