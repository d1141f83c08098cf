#include "tests/bench/report_experiments.h"

#include <algorithm>
#include <array>

namespace macula::bench {
namespace {

constexpr std::array kViews{
    ExperimentView{
        "tradeoff",
        "Speed against accuracy. Every point is a configuration: how long a frame takes, "
        "and how far it is from the truth. Dashed: whole pictures, coarser or with more "
        "samples, and what no other of them beats. Red: the foveated front. Hover over a "
        "point for its name; choose what is shown over what.",
        "cpu_ms", "rmse_f10", ""},
    ExperimentView{"ray",
                   "Foveated ray tracing with reprojection against the full renderer of the same "
                   "run: how many times faster, and what the eye is shown.",
                   "cpu_foveated_ms", "speedup", "lighting"},
    ExperimentView{
        "lightcuts",
        "Many lights: error where the person looks (25 degrees) over time, by method. sl: "
        "stochastic lightcuts with as many lights asked everywhere.",
        "cpu_ms", "mse_f25", "method"},
    ExperimentView{"culling",
                   "Light reflected once, by virtual point lights of which few are kept: error in "
                   "the fovea over time, by method. all_vpls keeps every one.",
                   "cpu_ms", "rmse_in150", "method"},
    ExperimentView{"sphere",
                   "Distance fields, sphere traced: what foveation costs outside the fovea (FLIP) "
                   "over time. full: every pixel by plain steps.",
                   "cpu_ms", "flip", "method"},
    ExperimentView{
        "reprojection",
        "The newest frame, warped to where the head is by now, against a picture rendered "
        "there: what is left of a latency, by method.",
        "latency_ms", "psnr_db", "method"},
    ExperimentView{
        "streaming",
        "A stream over links as they are: how old the pose is that a picture was made for "
        "when it is shown.",
        "kbps", "age_p95_ms", "link"},
    ExperimentView{"codecs",
                   "Colour on its way: bytes of a frame against what is lost within 10 degrees of "
                   "the gaze. h264-foveal spends its bits there.",
                   "bytes_per_frame", "psnr_f10_db", "codec"},
    ExperimentView{
        "maps",
        "How many cells a frame is made of, and how good it can look at best, beside the "
        "maps of other streaming systems.",
        "cells_pct", "gp_psnr_best_db", "map"},
    ExperimentView{
        "scaling",
        "One frame on several nodes: what each further rank brings. Rows marked simulated "
        "replay measured costs through a model of the network.",
        "ranks", "efficiency", "balance"},
};
constexpr ExperimentView kUnknown{};

}  // namespace

const ExperimentView& experiment_view(std::string_view experiment) {
  const auto found = std::ranges::find(kViews, experiment, &ExperimentView::experiment);
  return found == kViews.end() ? kUnknown : *found;
}

int experiment_order(std::string_view experiment) {
  const auto found = std::ranges::find(kViews, experiment, &ExperimentView::experiment);
  return static_cast<int>(found - kViews.begin());
}

}  // namespace macula::bench
