#include "tests/bench/lightcuts_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "shared/image/png.h"
#include "tests/bench/lightcuts_stages.h"

namespace macula::bench {
namespace {

using kernels::lightcuts::Config;
using kernels::lightcuts::CutSizes;
using kernels::lightcuts::PerceptionConfig;
using kernels::lightcuts::PerceptionMode;

constexpr float kDefaultAlpha = PerceptionConfig{}.alpha;

template <class... Values>
std::string text(const char* format, Values... values) {
  char line[96];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

const ColorScale& share_scale() {
  static const ColorScale scale{"fsfm, flfm, fpsm, share taken", 0.0F, 1.0F, Ticks::Linear};
  return scale;
}
ColorScale node_scale() {
  return {"light samples a pixel: nodes of its cut", 0.0F, static_cast<float>(Config{}.most_nodes),
          Ticks::Linear};
}

ColorScale error_scale_to(float most) {
  return {"error, root of the mean square over channels, of what a display shows (1: white)", 0.0F,
          most, Ticks::Linear};
}

Plane<Rgb8> error_picture(Plane<float> squares, const ColorScale& scale) {
  for (float& value : squares.pixels()) value = std::sqrt(value);
  return false_color(squares, scale);
}

std::string told(const char* what, const Regional& of) {
  return text("%s %.2g in, %.2g out", what, of.f25, of.out25);
}

}  // namespace

LightcutsPictures::LightcutsPictures(std::string folder, std::string suffix, std::string title,
                                     const LightcutsSetting& setting, const LightcutsJudge& judge,
                                     scheduling::TileScheduler& scheduler)
    : folder_(std::move(folder)),
      suffix_(std::move(suffix)),
      title_(std::move(title)),
      setting_(setting),
      judge_(judge),
      scheduler_(scheduler),
      within_f25_(judge.within_f25()) {
  std::error_code ignored;  // a folder that cannot be made shows when it is written to
  std::filesystem::create_directories(folder_, ignored);
}

void LightcutsPictures::add(const ShownFigures& figures, const Config& config,
                            const Plane<Rgb>& radiance) {
  Shown one{figures, shown(radiance), {}, judge_.error_map(radiance)};
  constexpr float kSingly = 0.2F;  // one range for all scenes
  write(figures.label, one.picture);
  write("error_" + figures.label, error_picture(one.squares, error_scale_to(kSingly)));
  if (config.sizes == CutSizes::Perceived) {
    one.map = false_color(plan_of(setting_, config, scheduler_).maps.front().map, share_scale());
    write("fpsm_" + figures.label, one.map);
  }
  all_.push_back(std::move(one));
}

void LightcutsPictures::write_sheets() const {
  write_maps();
  write_errors();
  write_alphas();
  write_stages();
}

/// Every mode's at the mean number of samples that the default has.
void LightcutsPictures::write_maps() const {
  const auto plan = plan_of(setting_, perceived_cuts(PerceptionMode::Attenuation), scheduler_);
  const double mean = mean_of(as_floats(plan.cut_nodes.front()));
  FigureSheet sheet{
      title_ + text(": maps of samples, %.1f a pixel each", mean), 4, {}, {node_scale()}};
  struct Named {
    const char *name, *what;
    PerceptionMode mode;
  };
  for (const Named& one : {Named{"attenuation", "fpsm: attenuation", PerceptionMode::Attenuation},
                           Named{"stengel", "afsm: stengel", PerceptionMode::Stengel},
                           Named{"difference", "fpsm: difference", PerceptionMode::Difference},
                           Named{"printed", "fpsm: as printed", PerceptionMode::Printed}}) {
    Config config = perceived_cuts(one.mode);
    config.mean_nodes = mean;
    const Plane<float> nodes = as_floats(plan_of(setting_, config, scheduler_).cut_nodes.front());
    const Plane<Rgb8> picture = false_color(nodes, node_scale());
    write(std::string("map_") + one.name, picture);
    sheet.panels.push_back({ringed(picture), {one.what, told("samples", judge_.mean(nodes))}});
  }
  write("maps", drawn(sheet));
}

/// A method's before its baseline's, as nearly at its time as the curve has a point.
std::vector<const LightcutsPictures::Shown*> LightcutsPictures::compared() const {
  std::vector<const Shown*> columns;
  const Shown* adaptive = find("sl_as", kDefaultAlpha);
  if (adaptive != nullptr) columns.push_back(adaptive);
  for (const char* name : {"paper", "ours"}) {
    const Shown* method = find(name, kDefaultAlpha);
    if (method == nullptr) continue;
    columns.push_back(method);
    const Shown* baseline = nearest_in_time(method->figures.baseline, method->figures.cpu_ms);
    if (baseline != nullptr) columns.push_back(baseline);
  }
  return columns;
}

/// Up to a round number that no region's root mean square error passes.
ColorScale LightcutsPictures::error_scale(const std::vector<const Shown*>& all) {
  double largest = 0.0;
  for (const Shown* one : all)
    largest = std::max({largest, one->figures.mse.f25, one->figures.mse.out25});
  largest = std::sqrt(largest);
  for (const float most : {0.01F, 0.02F, 0.05F, 0.1F, 0.2F, 0.5F})
    if (largest <= static_cast<double>(most)) return error_scale_to(most);
  return error_scale_to(1.0F);
}

void LightcutsPictures::write_errors() const {
  const std::vector<const Shown*> columns = compared();
  if (columns.empty()) return;
  const ColorScale scale = error_scale(columns);
  FigureSheet sheet{
      title_ + ": methods, then baselines of about their time (ring: 25 degrees around the gaze)",
      static_cast<int>(columns.size()) + 1,
      {{ringed(shown(judge_.reference())), {"reference"}}},
      {scale}};
  for (const Shown* one : columns) {
    sheet.panels.push_back(
        {ringed(one->picture),
         {text("%s, %.0f ms", one->figures.label.c_str(), one->figures.cpu_ms)}});
  }
  sheet.panels.push_back(
      {ringed(error_picture(judge_.noise_map(), scale)), {"noise of the reference"}});
  for (const Shown* one : columns)
    sheet.panels.push_back(
        {ringed(error_picture(one->squares, scale)), {told("mse", one->figures.mse)}});
  write("errors", drawn(sheet));
}

void LightcutsPictures::write_alphas() const {
  std::vector<const Shown*> columns;
  for (const Shown& one : all_)
    if (one.figures.name == "paper") columns.push_back(&one);
  if (columns.size() < 2) return;
  std::ranges::sort(columns, {}, [](const Shown* one) { return one->figures.alpha; });
  const ColorScale scale = error_scale(columns);
  FigureSheet sheet{
      title_ +
          ": the method of the paper by its threshold alpha (ring: 25 degrees around the gaze)",
      static_cast<int>(columns.size()),
      {},
      {share_scale(), scale}};
  for (const Shown* one : columns) {
    sheet.panels.push_back({ringed(one->picture),
                            {text("alpha %g, %.0f ms", static_cast<double>(one->figures.alpha),
                                  one->figures.cpu_ms)}});
  }
  for (const Shown* one : columns)
    sheet.panels.push_back({ringed(one->map), {told("samples", one->figures.lspp)}});
  for (const Shown* one : columns)
    sheet.panels.push_back(
        {ringed(error_picture(one->squares, scale)), {told("mse", one->figures.mse)}});
  write("alphas", drawn(sheet));
}

void LightcutsPictures::write_stages() const {
  const Shown* paper = find("paper", kDefaultAlpha);
  if (paper == nullptr) return;
  const Config config = paper_cuts();
  const ColorScale scale = error_scale({paper});
  const LightcutsStagePlanes planes = stage_planes_of(setting_, config, scheduler_);
  const int width = setting_.display.width_px, height = setting_.display.height_px;
  const Plane<float> nodes = as_floats(planes.cut_nodes);
  FigureSheet sheet{
      title_ + ": what the stages of a frame make", 4, {}, {share_scale(), node_scale(), scale}};
  sheet.panels = {
      {enlarged(shown(planes.low_picture), config.low_resolution, width, height),
       {text("low resolution, %d nodes", config.low_nodes)}},
      {ringed(false_color(planes.maps.spatial, share_scale())), {"fsfm: acuity, edges"}},
      {ringed(false_color(planes.maps.luminance, share_scale())), {"flfm: acuity, contrast"}},
      {ringed(false_color(planes.maps.map, share_scale())), {"fpsm"}},
      {ringed(false_color(nodes, node_scale())), {told("samples", judge_.mean(nodes))}},
      {ringed(false_color(planes.taken, share_scale())),
       {told("taken", judge_.mean(planes.taken))}},
      {ringed(paper->picture), {text("paper, %.0f ms", paper->figures.cpu_ms)}},
      {ringed(error_picture(paper->squares, scale)), {told("mse", paper->figures.mse)}}};
  write("stages", drawn(sheet));
}

const LightcutsPictures::Shown* LightcutsPictures::find(const std::string& name,
                                                        float alpha) const {
  const auto found = std::ranges::find_if(all_, [&](const Shown& one) {
    return one.figures.name == name && one.figures.alpha == alpha;
  });
  return found == all_.end() ? nullptr : &*found;
}

const LightcutsPictures::Shown* LightcutsPictures::nearest_in_time(const std::string& baseline,
                                                                   double cpu_ms) const {
  const Shown* nearest = nullptr;
  const auto apart = [&](const Shown& one) {
    return std::abs(std::log(one.figures.cpu_ms / cpu_ms));
  };
  for (const Shown& one : all_) {
    if (one.figures.name != baseline) continue;
    if (nearest == nullptr || apart(one) < apart(*nearest)) nearest = &one;
  }
  return nearest;
}

Plane<Rgb8> LightcutsPictures::ringed(Plane<Rgb8> picture) const {
  constexpr Rgb8 kRing{255, 255, 255};
  outline(picture, within_f25_, dot_px(picture.width()) / 2 + 1, kRing);
  return picture;
}

Plane<Rgb8> LightcutsPictures::shown(const Plane<Rgb>& radiance) const {
  Plane<Rgb8> picture;
  image::encode(setting_.view.tone, radiance, picture);
  return picture;
}

void LightcutsPictures::write(const std::string& name, const Plane<Rgb8>& picture) const {
  const std::string path = folder_ + "/" + name + suffix_ + ".png";
  if (!image::write_png(path, picture))
    std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
}

}  // namespace macula::bench
