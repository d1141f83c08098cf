#include "tests/bench/tradeoff_cases.h"

#include <algorithm>
#include <charconv>

#include "shared/base/text.h"

namespace macula::bench {
namespace {

using kernels::KnobValue;

/// Whole pictures, coarser or with more samples a pixel: what no foveation can do for its time.
std::vector<std::string> uniform_of(const std::string& off, const std::string& more,
                                    std::initializer_list<int> counts) {
  std::vector<std::string> all;
  for (const char* scale : {"0.15", "0.25", "0.35", "0.5", "0.71", "1"})
    all.push_back(base::concat("grid=uniform scale=", scale, off));
  for (const int count : counts)
    all.push_back(base::concat("grid=uniform", off, " ", more, "=", count));
  return all;
}

/// The whole picture by the paper's mask and reprojection.
std::string remembered(const std::string& words) {
  return "grid=uniform model=ray-medium method=foveated" + words;
}

/// Curves that are whole within 10 degrees, with more samples: what a foveated picture does with
/// much time. The first falls steeply beyond.
void add_dense(std::vector<std::string>& all, const std::string& words,
               std::initializer_list<int> counts) {
  for (const int count : counts)
    for (const char* model : {"inner=10 outer=15 floor=0.01", "model=ray-medium"})
      all.push_back(base::concat(model, words, " samples=", count));
}

/// What every kernel's frames share: density of the grid, its curve, codecs.
std::vector<std::string> with_server_wide(const std::string& words,
                                          std::initializer_list<int> counts,
                                          std::vector<std::string> own) {
  std::vector<std::string> all{"scale=1"};
  for (const char* scale : {"0.2", "0.3", "0.4", "0.55", "0.75"})
    all.push_back(base::concat("scale=", scale));
  for (const char* model : {"ray-small", "ray-medium", "ray-large", "lightcuts", "culling"})
    all.push_back(base::concat("model=", model));
  for (const int quality : {50, 70, 85, 95}) all.push_back(base::concat("jpeg=", quality));
  for (const int divisor : {2, 4, 8}) all.push_back(base::concat("depth=", divisor));
  add_dense(all, words, counts);
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

TradeoffKernel ray() {
  return {"ray",
          "ray",
          0,
          {"posts", "atrium", "moving"},
          uniform_of("", "samples", {2, 4, 8, 16, 32}),
          with_server_wide("", {2, 4, 8, 16, 32},
                           {"samples=2",
                            "samples=4",
                            "samples=8",
                            "samples=16",
                            "lights=1",
                            "lights=2",
                            "lights=4",
                            "lights=16",
                            "ambient=1",
                            "ambient=2",
                            "ambient=8",
                            "scale=0.2 lights=1 ambient=1",
                            "scale=0.3 lights=1 ambient=1",
                            "scale=0.4 lights=1 ambient=1",
                            "scale=0.55 lights=1 ambient=1",
                            "scale=0.75 lights=2 ambient=2",
                            "lights=1 ambient=1",
                            "samples=2 lights=4 ambient=2",
                            "samples=4 lights=2 ambient=1",
                            "scale=0.75 samples=4 lights=4 ambient=2",
                            "samples=8 lights=4 ambient=2",
                            "samples=16 lights=4 ambient=2",
                            remembered(""),
                            remembered(" support=3"),
                            remembered(" support=8"),
                            remembered(" k_min=0.05"),
                            remembered(" k_max=0.9"),
                            remembered(" t_max=4"),
                            remembered(" t_max=64"),
                            remembered(" mask=independent"),
                            remembered(" budget=0.2"),
                            remembered(" budget=0.1"),
                            remembered(" post=on"),
                            remembered(" eps_depth=0.1"),
                            remembered(" eps_lum=0.3"),
                            "grid=uniform model=ray-small method=foveated",
                            "grid=uniform model=ray-large method=foveated",
                            "method=foveated",
                            "method=foveated post=on",
                            "method=foveated post=on lights=1 ambient=1",
                            "method=foveated post=on lights=1 ambient=1 scale=0.75",
                            "method=foveated post=on lights=1 ambient=1 scale=0.55",
                            "method=foveated post=on lights=1 ambient=1 scale=0.4",
                            "method=foveated post=on lights=1 ambient=1 scale=0.3",
                            "method=foveated post=on lights=1 ambient=1 scale=0.2"}),
          {"grid=uniform samples=32", "samples=16", remembered(" t_max=4"), remembered(" t_max=64"),
           remembered(" k_max=0.9"), remembered(" eps_depth=0.1")}};
}

TradeoffKernel lightcuts() {
  return {"lightcuts",
          "lightcuts",
          0,
          {"cornell-lights", "room", "study"},
          uniform_of(" ambient=1", "samples", {2, 4, 8, 16, 32}),
          with_server_wide(" ambient=1", {1, 2, 4, 8, 16, 32},
                           {"nodes=1",
                            "nodes=2",
                            "nodes=4",
                            "nodes=16",
                            "nodes=48",
                            "nodes=1 ambient=1 scale=0.2",
                            "nodes=1 ambient=1 scale=0.3",
                            "nodes=1 ambient=1 scale=0.4",
                            "nodes=1 ambient=1 scale=0.55",
                            "nodes=2 ambient=1 scale=0.75",
                            "nodes=1 ambient=1",
                            "samples=2 nodes=4 ambient=1",
                            "samples=4 nodes=4 ambient=1",
                            "samples=8 nodes=4 ambient=1",
                            "samples=16 nodes=4 ambient=1",
                            "nodes=2 ambient=1",
                            "nodes=4 ambient=1",
                            "nodes=4 ambient=2 scale=0.55",
                            "nodes=4 ambient=2 scale=0.75",
                            "nodes=16 ambient=8",
                            "denoise=no",
                            "nodes=1 denoise=no",
                            "sizes=perceived source=walks",
                            "sizes=perceived source=walks alpha=0.025",
                            "sizes=perceived source=walks alpha=0.1",
                            "sizes=perceived source=walks alpha=0.2",
                            "sizes=perceived source=walks alpha=0.4",
                            "sizes=perceived source=walks most=8",
                            "sizes=perceived source=walks most=16",
                            "sizes=perceived source=walks most=96",
                            "sizes=perceived source=walks mode=difference",
                            "sizes=perceived source=walks mode=stengel",
                            "sizes=perceived source=low-resolution",
                            "sizes=perceived source=low-resolution low=4",
                            "sizes=perceived source=low-resolution low=16",
                            "sizes=perceived source=reservoirs",
                            "sizes=perceived source=reservoirs rays=2",
                            "sizes=perceived source=reservoirs denoise=no",
                            "sizes=perceived source=reservoirs scale=0.55"}),
          {"grid=uniform ambient=1 samples=32", "samples=16 nodes=4 ambient=1",
           "sizes=perceived source=walks alpha=0.2", "sizes=perceived source=walks most=96",
           "sizes=perceived source=low-resolution low=16"}};
}

TradeoffKernel culling() {
  return {"culling",
          "brute",
          1,
          {"posts", "moving", "nave"},
          uniform_of(" ambient=1", "samples", {2, 4, 8}),
          with_server_wide(" ambient=1", {1, 2, 4},
                           {"kept=256",
                            "kept=512",
                            "kept=2048",
                            "kept=4096",
                            "points=16",
                            "points=256",
                            "points=1024",
                            "hiding=lamp-maps",
                            "hiding=nothing",
                            "space=cells",
                            "space=log-polar",
                            "classes=1",
                            "classes=16",
                            "asked=2",
                            "asked=4",
                            "asked=16",
                            "asked=32",
                            "nearest=0.005",
                            "nearest=0.1",
                            "map=32",
                            "map=128",
                            "blur=0",
                            "newest=1",
                            "newest=0.1",
                            "picture=1",
                            "ambient=1 scale=0.2 asked=2 lights=1 kept=256 map=32 points=32",
                            "ambient=1 scale=0.3 asked=2 lights=1 kept=256 map=32 points=32",
                            "ambient=1 scale=0.4 asked=2 lights=1 kept=256 map=32 points=32",
                            "ambient=1 scale=0.55 asked=2 lights=1 kept=256 map=32 points=32",
                            "ambient=1 scale=0.75 asked=2 lights=1 kept=256 map=32 points=32",
                            "ambient=1 asked=2 lights=1 kept=256 map=32 points=32",
                            "ambient=1 scale=0.75 asked=4 lights=1",
                            "ambient=1 asked=2 lights=1",
                            "ambient=1 asked=4 lights=2",
                            "ambient=2 lights=4",
                            "samples=2 ambient=2 lights=4",
                            "samples=2 map=32",
                            "samples=4 ambient=1 lights=2",
                            "samples=4 space=cells asked=4 ambient=2 lights=4"}),
          {"grid=uniform ambient=1 samples=8", "kept=4096", "points=1024", "map=128",
           "samples=4 space=cells asked=4 ambient=2 lights=4"}};
}

TradeoffKernel sphere() {
  return {"sphere",
          "sphere",
          0,
          {"primitives", "columns", "temple"},
          uniform_of(" foveation=off", "samples", {2, 4, 8, 16}),
          with_server_wide("", {2, 4, 8, 16},
                           {"samples=2",
                            "samples=4",
                            "samples=8",
                            "samples=16",
                            "scale=0.3 samples=4",
                            "scale=0.55 samples=2",
                            "scale=0.55 samples=4",
                            "scale=0.75 samples=4",
                            "scale=0.75 samples=8",
                            "foveation=off",
                            "foveation=off samples=4",
                            "foveation=off samples=16",
                            "grid=uniform fovea=2.5",
                            "grid=uniform fovea=5",
                            "grid=uniform fovea=7.5",
                            "grid=uniform fovea=10",
                            "grid=uniform fovea=15",
                            "grid=uniform refresh=2",
                            "grid=uniform refresh=4",
                            "grid=uniform samples=4",
                            "grid=uniform samples=16",
                            "grid=uniform edges=albedo",
                            "grid=uniform edges=shaded",
                            "grid=uniform detail=0.05",
                            "grid=uniform detail=0.3",
                            "grid=uniform foveation=off tracing=full",
                            "grid=uniform foveation=off tracing=full-best",
                            "grid=uniform foveation=off tracing=paper-pyramid",
                            "refresh=4"}),
          {"grid=uniform foveation=off samples=16", "grid=uniform samples=16",
           "foveation=off samples=16", "grid=uniform foveation=off tracing=full"}};
}

template <class Number>
bool read(const std::string& text, Number low, Number high, Number& into) {
  return kernels::turn_number(into, text, low, high);
}

Result<bool> take_frame_word(const KnobValue& word, FrameSettings& settings) {
  const auto allowed = [&](const char* what) -> Result<bool> {
    return base::bad_input(base::concat(word.name, " is '", word.value, "'"), "configuration",
                           base::concat("allowed: ", what));
  };
  if (word.name == "grid") {
    if (word.value != "foveal" && word.value != "uniform") return allowed("foveal, uniform");
    settings.grid = word.value == "foveal" ? FrameGrid::Foveal : FrameGrid::Uniform;
    return true;
  }
  if (word.name == "scale") {
    if (!read(word.value, 0.05, 1.0, settings.scale)) return allowed("0.05 to 1");
    return true;
  }
  if (word.name == "model") {
    const auto model = foveation::find_rate_model(word.value);
    if (!model) return base::forward(model);
    settings.model = *model;
    return true;
  }
  if (word.name == "inner" || word.name == "outer" || word.name == "floor") {
    const bool is_floor = word.name == "floor";
    double value = 0.0;
    if (!read(word.value, is_floor ? 0.0001 : 0.0, is_floor ? 1.0 : 180.0, value))
      return allowed(is_floor ? "0.0001 to 1" : "0 to 180 degrees");
    settings.model.curve = foveation::RateCurve::Ray;
    if (is_floor)
      settings.model.floor = value;
    else
      (word.name == "inner" ? settings.model.inner : settings.model.outer) = Degrees{value};
    return true;
  }
  if (word.name == "jpeg") {
    int quality = 0;
    if (!read(word.value, 1, 100, quality)) return allowed("1 to 100");
    settings.jpeg = quality;
    return true;
  }
  if (word.name == "depth") {
    if (word.value != "1" && word.value != "2" && word.value != "4" && word.value != "8")
      return allowed("1, 2, 4, 8");
    return read(word.value, 1, 8, settings.depth_divisor);
  }
  return false;
}

}  // namespace

Result<FrameSettings> parse_frame_settings(std::string_view config) {
  const auto words = kernels::parse_knobs(config);
  if (!words) return base::forward(words);
  FrameSettings settings;
  for (const KnobValue& word : *words) {
    const auto taken = take_frame_word(word, settings);
    if (!taken) return base::forward(taken);
    if (!*taken) settings.knobs.push_back(word);
  }
  return settings;
}

std::span<const TradeoffKernel> tradeoff_kernels() {
  static const std::vector<TradeoffKernel> kAll{ray(), lightcuts(), culling(), sphere()};
  return kAll;
}

}  // namespace macula::bench
