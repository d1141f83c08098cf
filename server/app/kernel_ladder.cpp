#include "server/app/kernel_ladder.h"

#include <filesystem>
#include <iostream>

#include "server/app/ladder_file.h"
#include "server/kernels/registry.h"
#include "shared/base/text.h"

namespace macula::server_app {
namespace {

kernels::KernelOptions kernel_options(const Options& options) {
  kernels::KernelOptions kernel;
  kernel.area_light_samples = options.area_samples;
  kernel.ambient_samples = options.ambient_samples;
  kernel.reuse = options.reuse ? kernels::Reuse::EarlierFrames : kernels::Reuse::Nothing;
  if (options.perceived_lights) kernel.light_share = kernels::LightShare::Perceived;
  return kernel;
}

bool has_knobs_by_hand(const Options& options) {
  const Options untouched;
  return !options.knobs.empty() || options.area_samples != untouched.area_samples ||
         options.ambient_samples != untouched.ambient_samples;
}

/// A time to hold goes along the ladder, too, unless knobs were turned by hand: those stay.
bool wants_ladder(const Options& options) {
  return options.quality || options.max_error || (options.target_ms && !has_knobs_by_hand(options));
}

}  // namespace

Result<std::unique_ptr<kernels::Kernel>> choose_kernel(const Options& options,
                                                       const std::string& name) {
  const auto knobs = kernels::parse_knobs(options.knobs);
  if (!knobs) return base::forward(knobs);
  return kernels::make_kernel(name, kernel_options(options), *knobs);
}

Result<Ladder> load_ladder(const Options& options, const std::string& installed,
                           const std::string& kernel) {
  if (!wants_ladder(options)) return Ladder{};
  const bool is_asked_for = !options.ladders.empty();
  const std::string folder = is_asked_for ? options.ladders : installed;
  const std::string path = base::concat(folder, "/", kernel, ".toml");
  if (!is_asked_for && !std::filesystem::exists(path)) {
    if (options.max_error)
      return base::bad_input("there is no measured ladder of kernel " + kernel, path,
                             "--ladders DIR names another folder; or leave --max-error out");
    std::cout << "note: no quality ladder of kernel " << kernel << " at " << path
              << ": the periphery's resolution alone gives way\n";
    return Ladder{};
  }
  const auto file = load_ladder_file(path);
  if (!file) return base::forward(file);
  if (file->kernel != kernel)
    return base::bad_input("is the ladder of kernel " + file->kernel, path, "that of " + kernel);
  Ladder ladder{std::make_shared<session::QualityLadder>(file->ladder), {}, {}};
  for (const session::QualityStep& step : file->ladder.steps()) {
    auto made = kernels::make_kernel(kernel, kernel_options(options), step.knobs);
    if (!made) return base::forward(made);
    ladder.kernels.push_back(std::move(*made));
  }
  auto reference = kernels::make_reference(kernel, kernel_options(options));
  if (!reference) return base::forward(reference);
  ladder.reference = std::move(*reference);
  return ladder;
}

void print_ladder(const Ladder& ladder, const Options& options) {
  if (ladder.steps == nullptr) return;
  const double quality = options.max_error && !options.target_ms && !options.quality
                             ? ladder.steps->quality_for_error(*options.max_error)
                             : options.quality.value_or(session::kBestQuality);
  const session::QualityPoint point = ladder.steps->at(quality),
                              floor = ladder.steps->at(session::kLeastQuality);
  std::cout << "quality " << point.quality << " of 10: periphery " << point.scale << ", knobs "
            << kernels::text_of(ladder.steps->steps()[point.step].knobs) << ", measured error "
            << point.rmse << "; the floor has " << floor.rmse << " for " << floor.cost / point.cost
            << " of its time\n";
  if (options.max_error && point.rmse > *options.max_error)
    std::cout << "warning: --max-error " << *options.max_error
              << " is less than the ladder's best; the best is rendered\n";
}

}  // namespace macula::server_app
