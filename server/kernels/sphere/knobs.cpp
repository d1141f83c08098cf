#include "server/kernels/sphere/knobs.h"

namespace macula::kernels::sphere {
namespace {

using SphereKnob = Knob<Config>;

bool turn_samples(Config& c, std::string_view value) {
  if (!turn_number(c.samples_per_cell, value, 1, kMostSamples)) return false;
  c.block_samples = block_samples_for(c.samples_per_cell);
  return true;
}

/// The mask falls to nothing at twice the fovea's radius, as by default.
bool turn_fovea(Config& c, std::string_view value) {
  double degrees = 0.0;
  if (!turn_number(degrees, value, 0.0, 90.0)) return false;
  c.mask.fovea = Degrees{degrees}, c.mask.outer = Degrees{2.0 * degrees};
  return true;
}

bool turn_foveation(Config& c, std::string_view value) {
  return turn_choice(c.foveation, value,
                     std::array{std::pair<std::string_view, Foveation>{"off", Foveation::Off},
                                std::pair<std::string_view, Foveation>{"on", Foveation::On}});
}

bool turn_refresh(Config& c, std::string_view value) {
  using Named = std::pair<std::string_view, Refresh>;
  return turn_choice(c.refresh, value,
                     std::array{Named{"1", Refresh::EveryFrame}, Named{"2", Refresh::EverySecond},
                                Named{"4", Refresh::EveryFourth}});
}

bool turn_tracing(Config& c, std::string_view value) {
  using Named = std::pair<std::string_view, Tracing>;
  return turn_choice(c.tracing, value,
                     std::array{Named{"full", Tracing::Full}, Named{"full-best", Tracing::FullBest},
                                Named{"paper-pyramid", Tracing::PaperPyramid},
                                Named{"pyramid", Tracing::Pyramid}});
}

bool turn_edges(Config& c, std::string_view value) {
  using Named = std::pair<std::string_view, EdgeSource>;
  return turn_choice(
      c.mask.edges, value,
      std::array{Named{"depth", EdgeSource::Depth}, Named{"albedo", EdgeSource::Albedo},
                 Named{"shaded", EdgeSource::Shaded}});
}

constexpr std::array kKnobs{
    SphereKnob{"samples", "1 to 16", turn_samples},
    SphereKnob{"foveation", "off, on", turn_foveation},
    SphereKnob{"fovea", "0 to 90 degrees", turn_fovea},
    SphereKnob{"refresh", "1, 2, 4 frames", turn_refresh},
    SphereKnob{"tracing", "full, full-best, paper-pyramid, pyramid", turn_tracing},
    SphereKnob{"edges", "depth, albedo, shaded", turn_edges},
    SphereKnob{
        "detail", "0 to 1",
        [](Config& c, std::string_view value) { return turn_number(c.detail, value, 0.0F, 1.0F); }},
};

}  // namespace

Result<void> turn_knobs(std::span<const KnobValue> values, Config& config) {
  return kernels::turn_knobs("sphere", kKnobs, values, config);
}

}  // namespace macula::kernels::sphere
