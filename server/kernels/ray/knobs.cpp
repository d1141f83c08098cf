#include "server/kernels/ray/knobs.h"

namespace macula::kernels::ray {
namespace {

constexpr int kMostSamples = 1024;

using RayKnob = Knob<Config>;

bool turn_method(Config& c, std::string_view value) {
  return turn_choice(c.foveated.method, value,
                     std::array{std::pair<std::string_view, Method>{"full", Method::Full},
                                std::pair<std::string_view, Method>{"foveated", Method::Foveated}});
}

bool turn_mask(Config& c, std::string_view value) {
  return turn_choice(
      c.foveated.mask, value,
      std::array{std::pair<std::string_view, MaskKind>{"blue-noise", MaskKind::BlueNoise},
                 std::pair<std::string_view, MaskKind>{"independent", MaskKind::Independent}});
}

bool turn_post(Config& c, std::string_view value) {
  return turn_choice(c.foveated.post_filter, value,
                     std::array{std::pair<std::string_view, PostFilter>{"off", PostFilter::Off},
                                std::pair<std::string_view, PostFilter>{"on", PostFilter::On}});
}

bool turn_least_weight(Config& c, std::string_view value) {
  return turn_number(c.foveated.color_age.least, value, 0.001F, c.foveated.color_age.most);
}

bool turn_most_weight(Config& c, std::string_view value) {
  return turn_number(c.foveated.color_age.most, value, c.foveated.color_age.least, 1.0F);
}

constexpr std::array kKnobs{
    RayKnob{"samples", kSamplesAllowed, turn_samples},
    RayKnob{"lights", kLightsAllowed, turn_lights},
    RayKnob{"ambient", kAmbientAllowed, turn_ambient},
    RayKnob{"environment", kLightsAllowed, turn_environment},
    RayKnob{"method", "full, foveated", turn_method},
    RayKnob{"support", "1 to 64 cells",
            [](Config& c, std::string_view value) {
              return turn_number(c.foveated.support_spacing, value, 1.0F, 64.0F);
            }},
    RayKnob{"mask", "blue-noise, independent", turn_mask},
    RayKnob{"post", "off, on", turn_post},
    RayKnob{"k_min", "0.001 to k_max", turn_least_weight},
    RayKnob{"k_max", "k_min to 1", turn_most_weight},
    RayKnob{"t_max", "1 to 1000 frames",
            [](Config& c, std::string_view value) {
              return turn_number(c.foveated.color_age.full_age, value, 1, 1000);
            }},
    RayKnob{"eps_depth", "0 to 1",
            [](Config& c, std::string_view value) {
              return turn_number(c.foveated.depth_threshold, value, 0.0F, 1.0F);
            }},
    RayKnob{"eps_lum", "0 to 1",
            [](Config& c, std::string_view value) {
              return turn_number(c.foveated.luminance_threshold, value, 0.0F, 1.0F);
            }},
    RayKnob{"turn", "0.01 to 1000 lobe widths",
            [](Config& c, std::string_view value) {
              return turn_number(c.foveated.turn_threshold, value, 0.01F, 1000.0F);
            }},
    RayKnob{"budget", "0.01 to 1",
            [](Config& c, std::string_view value) {
              return turn_number(c.foveated.ray_budget, value, 0.01F, 1.0F);
            }},
};

}  // namespace

bool turn_samples(Config& config, std::string_view value) {
  return turn_number(config.samples_per_cell, value, 1, kMostSamples);
}

bool turn_lights(Config& config, std::string_view value) {
  return turn_number(config.area_light_samples, value, 1, kMostSamples);
}

bool turn_ambient(Config& config, std::string_view value) {
  return turn_number(config.ambient_samples, value, 0, kMostSamples);
}

bool turn_environment(Config& config, std::string_view value) {
  return turn_number(config.environment_samples, value, 1, kMostSamples);
}

Result<void> turn_knobs(std::span<const KnobValue> values, Config& config) {
  return kernels::turn_knobs("ray", kKnobs, values, config);
}

}  // namespace macula::kernels::ray
