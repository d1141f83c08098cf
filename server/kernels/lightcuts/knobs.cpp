#include "server/kernels/lightcuts/knobs.h"

#include "server/kernels/ray/knobs.h"
#include "shared/base/text.h"

namespace macula::kernels::lightcuts {
namespace {

using CutKnob = Knob<Config>;

/// A knob of kernel `ray` for the tiles below.
template <bool (*kTurn)(ray::Config&, std::string_view)>
bool turn_tiles(Config& c, std::string_view value) {
  return kTurn(c.ray, value);
}

bool turn_sizes(Config& c, std::string_view value) {
  return turn_choice(
      c.sizes, value,
      std::array{std::pair<std::string_view, CutSizes>{"uniform", CutSizes::Uniform},
                 std::pair<std::string_view, CutSizes>{"perceived", CutSizes::Perceived}});
}

bool turn_source(Config& c, std::string_view value) {
  using Named = std::pair<std::string_view, LightSource>;
  return turn_choice(c.source, value,
                     std::array{Named{"walks", LightSource::Walks},
                                Named{"low-resolution", LightSource::LowResolution},
                                Named{"reservoirs", LightSource::Reservoirs}});
}

bool turn_mode(Config& c, std::string_view value) {
  using Named = std::pair<std::string_view, PerceptionMode>;
  return turn_choice(c.perception.mode, value,
                     std::array{Named{"printed", PerceptionMode::Printed},
                                Named{"difference", PerceptionMode::Difference},
                                Named{"attenuation", PerceptionMode::Attenuation},
                                Named{"stengel", PerceptionMode::Stengel}});
}

bool turn_denoise(Config& c, std::string_view value) {
  return turn_choice(c.denoise, value,
                     std::array{std::pair<std::string_view, Denoise>{"no", Denoise::No},
                                std::pair<std::string_view, Denoise>{"yes", Denoise::Yes}});
}

bool turn_stereo(Config& c, std::string_view value) {
  return turn_choice(c.stereo, value,
                     std::array{std::pair<std::string_view, StereoReuse>{"no", StereoReuse::No},
                                std::pair<std::string_view, StereoReuse>{"yes", StereoReuse::Yes}});
}

bool turn_gloss(Config& c, std::string_view value) {
  return turn_choice(c.gloss, value,
                     std::array{std::pair<std::string_view, Gloss>{"no", Gloss::No},
                                std::pair<std::string_view, Gloss>{"yes", Gloss::Yes}});
}

constexpr std::array kKnobs{
    CutKnob{"samples", ray::kSamplesAllowed, turn_tiles<ray::turn_samples>},
    CutKnob{"nodes", ray::kLightsAllowed, turn_tiles<ray::turn_lights>},
    CutKnob{"ambient", ray::kAmbientAllowed, turn_tiles<ray::turn_ambient>},
    CutKnob{"environment", ray::kLightsAllowed, turn_tiles<ray::turn_environment>},
    CutKnob{"sizes", "uniform, perceived", turn_sizes},
    CutKnob{"source", "walks, low-resolution, reservoirs", turn_source},
    CutKnob{"mode", "printed, difference, attenuation, stengel", turn_mode},
    CutKnob{"alpha", "0 to 1",
            [](Config& c, std::string_view value) {
              return turn_number(c.perception.alpha, value, 0.0F, 1.0F);
            }},
    CutKnob{"most", "1 to 1024 nodes",
            [](Config& c, std::string_view value) {
              return turn_number(c.most_nodes, value, 1, 1024);
            }},
    CutKnob{"least", "1 to 1024 nodes, no more than most",
            [](Config& c, std::string_view value) {
              return turn_number(c.least_nodes, value, 1, 1024);
            }},
    CutKnob{"low", "2 to 64 cells",
            [](Config& c, std::string_view value) {
              return turn_number(c.low_resolution, value, 2, 64);
            }},
    CutKnob{"rays", "1 to 64",
            [](Config& c, std::string_view value) {
              return turn_number(c.reservoirs.rays.most, value, 1, 64);
            }},
    CutKnob{"denoise", "no, yes", turn_denoise},
    CutKnob{"stereo_reuse", "no, yes", turn_stereo},
    CutKnob{"gloss", "no, yes", turn_gloss},
};

}  // namespace

Result<void> turn_knobs(std::span<const KnobValue> values, Config& config) {
  if (auto ok = kernels::turn_knobs("lightcuts", kKnobs, values, config); !ok) return ok;
  if (config.gloss == Gloss::No || config.ray.samples_per_cell == 1) return {};
  return base::bad_input(
      base::concat("gloss=yes with ", config.ray.samples_per_cell, " samples a cell"),
      "kernel lightcuts", "samples=1; reflections are averaged over frames");
}

}  // namespace macula::kernels::lightcuts
